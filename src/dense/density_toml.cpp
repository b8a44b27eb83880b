// SPDX-License-Identifier: BSD-3-Clause
// Density profiles as TOML text; docs/density.md describes the format.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "base/try.hpp"
#include "dense/density_profile.hpp"
#include "sensor/tomlpp.hpp"
#include "sensor/utf8.hpp"

namespace curlidar {
namespace {

constexpr double kMostFloat = 1e30;

struct TableKey {
  const char* key;
  RangeTable DensityProfile::*table;
};
constexpr TableKey kTables[] = {{"elevation_mdeg", &DensityProfile::elevation_mdeg},
                                {"return_permille", &DensityProfile::return_permille},
                                {"given_return_permille", &DensityProfile::given_return_permille},
                                {"bias_mm", &DensityProfile::bias_mm}};

struct TreesKey {
  const char* key;
  ObliviousTrees DensityProfile::*trees;
};
constexpr TreesKey kTrees[] = {{"returns", &DensityProfile::returns},
                               {"residual", &DensityProfile::residual},
                               {"confidence", &DensityProfile::confidence},
                               {"row_confidence", &DensityProfile::row_confidence}};

/// Reads one table of the file; the first failure is kept, and what is read after it is empty.
class Reader {
 public:
  Reader(const toml::table& table, const std::string& where) : table_(table), where_(where) {}

  std::string text(const char* key) {
    const toml::node* node = take(key);
    if (node == nullptr) return {};
    if (!node->is_string()) fail(*node, fmt::format("{} must be a string", key));
    return node->value_or(std::string());
  }
  std::int64_t whole(const char* key, std::int64_t otherwise, std::int64_t low, std::int64_t high) {
    const toml::node* node = take(key);
    if (node == nullptr) return otherwise;
    return whole_of(*node, key, low, high);
  }
  double number(const char* key) {
    const toml::node* node = take(key);
    if (node == nullptr) return missing(key);
    if (!node->is_number()) fail(*node, fmt::format("{} must be a number", key));
    return node->value_or(0.0);
  }
  /// A list of lists of numbers; at most `rows` of at most `columns`.
  template <class T>
  std::vector<std::vector<T>> lists(const char* key, std::size_t rows, std::size_t columns,
                                    std::int64_t low, std::int64_t high) {
    std::vector<std::vector<T>> out;
    const toml::array* array = list(take(key), key, rows);
    if (array == nullptr) return out;
    for (const toml::node& node : *array) {
      const toml::array* row = list(&node, key, columns);
      if (row == nullptr) return {};
      std::vector<T>& numbers = out.emplace_back();
      for (const toml::node& element : *row) {
        if constexpr (std::is_floating_point_v<T>) {
          const double value = element.value_or(std::numeric_limits<double>::quiet_NaN());
          if (!(std::abs(value) <= kMostFloat)) {
            fail(element, fmt::format("{}: numbers up to 1e30 are meant", key));
            return {};
          }
          numbers.push_back(static_cast<T>(value));
        } else {
          numbers.push_back(static_cast<T>(whole_of(element, key, low, high)));
        }
      }
    }
    return out;
  }
  const toml::table* child(const char* key) {
    const toml::node* node = take(key);
    if (node == nullptr) return nullptr;
    if (!node->is_table()) fail(*node, fmt::format("{} must be a table", key));
    return status_ ? node->as_table() : nullptr;
  }
  void fail(const toml::node& node, std::string_view what) { fail(node.source(), what); }
  void fail_here(std::string_view what) { fail(table_.source(), what); }
  /// The first failure; or that of a key nobody has asked for.
  Status finish() {
    for (const auto& [key, node] : table_) {
      if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
      fail(key.source(), fmt::format("unknown key \"{}\"; docs/density.md lists the keys",
                                     key.str().substr(0, 64)));
    }
    return status_;
  }

 private:
  const toml::node* take(const char* key) {
    known_.emplace_back(key);
    return status_ ? table_.get(key) : nullptr;
  }
  double missing(const char* key) {
    if (status_) fail(table_.source(), fmt::format("{} is missing", key));
    return 0;
  }
  void fail(const toml::source_region& source, std::string_view what) {
    if (!status_) return;
    status_ = Error{ErrorCode::invalid_argument,
                    fmt::format("{}, line {}: {}", where_, source.begin.line, what)};
  }
  std::int64_t whole_of(const toml::node& node, const char* key, std::int64_t low,
                        std::int64_t high) {
    const std::optional<std::int64_t> value = node.value<std::int64_t>();
    if (node.is_integer() && value && *value >= low && *value <= high) return *value;
    fail(node, fmt::format("{}: whole numbers from {} to {} are meant", key, low, high));
    return low;
  }
  const toml::array* list(const toml::node* node, const char* key, std::size_t most) {
    if (node == nullptr) return nullptr;
    const toml::array* array = node->as_array();
    if (array == nullptr || array->size() > most) {
      fail(*node, fmt::format("{}: a list of at most {} is meant", key, most));
      return nullptr;
    }
    return status_ ? array : nullptr;
  }

  const toml::table& table_;
  const std::string& where_;
  std::vector<std::string> known_;
  Status status_;
};

Result<ObliviousTrees> read_trees(const toml::table& table, const std::string& where) {
  Reader reader(table, where);
  ObliviousTrees trees;
  trees.depth = static_cast<std::size_t>(reader.whole("depth", 0, 1, kMaxTreeDepth));
  trees.base = reader.number("base");
  trees.unit = reader.number("unit");
  trees.cuts = reader.lists<float>("cuts", kMaxTreeFeatures, 255, 0, 0);
  const auto splits = reader.lists<std::uint8_t>("splits", kMaxTrees, 2 * kMaxTreeDepth, 0, 255);
  const auto leaves =
      reader.lists<std::int16_t>("leaves", kMaxTrees, 1u << kMaxTreeDepth, -32768, 32767);
  CURLIDAR_TRY(reader.finish());
  for (const auto& tree : splits) {
    if (tree.size() != 2 * trees.depth) {
      reader.fail_here(fmt::format("splits: {} numbers for each tree are meant", 2 * trees.depth));
    }
    for (std::size_t i = 0; i + 1 < tree.size(); i += 2) {
      trees.splits.push_back({tree[i], tree[i + 1]});
    }
  }
  for (const auto& tree : leaves) {
    trees.leaves.insert(trees.leaves.end(), tree.begin(), tree.end());
  }
  CURLIDAR_TRY(reader.finish());
  if (Status status = validate(trees); !status) reader.fail_here(status.error().message);
  CURLIDAR_TRY(reader.finish());
  return trees;
}

void read_table(Reader& reader, const char* key, std::size_t rows, RangeTable& table) {
  const auto numbers =
      reader.lists<std::int16_t>(key, kMaxDensityRows, RangeTable::kBins, -32768, 32767);
  if (numbers.empty()) return;
  if (numbers.size() != rows) {
    return reader.fail_here(
        fmt::format("{} has {} rows, the profile {}", key, numbers.size(), rows));
  }
  table = RangeTable(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    if (numbers[row].empty()) {
      return reader.fail_here(fmt::format("{}, row {}: a number is meant", key, row));
    }
    // What is left out at the end is as the last.
    RangeTable::Row& to = table.row(row);
    std::fill(std::copy(numbers[row].begin(), numbers[row].end(), to.begin()), to.end(),
              numbers[row].back());
  }
}

Result<DensityProfile> read_profile(const toml::table& root, const std::string& where) {
  Reader reader(root, where);
  DensityProfile profile;
  profile.name = reader.text("name");
  profile.description = reader.text("description");
  profile.rows = static_cast<std::size_t>(reader.whole("rows", 0, 0, kMaxDensityRows));
  profile.given_first =
      static_cast<std::size_t>(reader.whole("given_first", 0, 0, kMaxDensityRows));
  profile.given_every =
      static_cast<std::size_t>(reader.whole("given_every", 1, 1, kMaxDensityRows));
  if (const toml::table* tables = reader.child("tables")) {
    Reader inner(*tables, where);
    for (const TableKey& known : kTables) {
      read_table(inner, known.key, profile.rows, profile.*known.table);
    }
    CURLIDAR_TRY(inner.finish());
  }
  if (const toml::table* trees = reader.child("trees")) {
    Reader inner(*trees, where);
    for (const TreesKey& known : kTrees) {
      const toml::table* child = inner.child(known.key);
      if (child == nullptr) continue;
      CURLIDAR_TRY_ASSIGN(read, read_trees(*child, where));
      profile.*known.trees = std::move(read);
    }
    CURLIDAR_TRY(inner.finish());
  }
  CURLIDAR_TRY(reader.finish());
  if (Status status = validate(profile); !status) reader.fail_here(status.error().message);
  CURLIDAR_TRY(reader.finish());
  return profile;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') out += '\\';
    out += code < 0x20 || code == 0x7f ? fmt::format("\\u{:04X}", code) : std::string(1, c);
  }
  return out + "\"";
}

template <class Range>
void append_list(std::string& out, const Range& numbers) {
  out += "[";
  bool first = true;
  for (const auto& number : numbers) {
    out += fmt::format("{}{}", first ? "" : ",", number);
    first = false;
  }
  out += "],\n";
}

void append_table(std::string& out, const char* key, const RangeTable& table) {
  if (table.empty()) return;
  out += fmt::format("{} = [\n", key);
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const RangeTable::Row& row = table.row(i);
    std::size_t used = row.size();
    while (used > 1 && row[used - 2] == row.back()) --used;
    append_list(out, std::span(row).first(used));
  }
  out += "]\n";
}

/// The shortest text that reads as the same number and looks like one with a fraction.
std::string decimal(double number) {
  std::string text = fmt::format("{}", number);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

void append_trees(std::string& out, const char* key, const ObliviousTrees& trees) {
  if (trees.empty()) return;
  out += fmt::format("\n[trees.{}]\ndepth = {}\nbase = {}\nunit = {}\n", key, trees.depth,
                     decimal(trees.base), decimal(trees.unit));
  out += "cuts = [\n";
  for (const std::vector<float>& cuts : trees.cuts) append_list(out, cuts);
  out += "]\nsplits = [\n";
  const std::size_t leaves = std::size_t{1} << trees.depth;
  for (std::size_t tree = 0; tree < trees.trees(); ++tree) {
    std::vector<unsigned> numbers;
    for (const auto& split : std::span(trees.splits).subspan(tree * trees.depth, trees.depth)) {
      numbers.push_back(split.feature);
      numbers.push_back(split.level);
    }
    append_list(out, numbers);
  }
  out += "]\nleaves = [\n";
  for (std::size_t tree = 0; tree < trees.trees(); ++tree) {
    append_list(out, std::span(trees.leaves).subspan(tree * leaves, leaves));
  }
  out += "]\n";
}

}  // namespace

std::string density_profile_text(const DensityProfile& profile) {
  std::string out;
  out += fmt::format("name = {}\n", quoted(profile.name));
  out += fmt::format("description = {}\n", quoted(profile.description));
  if (profile.rows > 0) {
    out += fmt::format("rows = {}\ngiven_first = {}\ngiven_every = {}\n", profile.rows,
                       profile.given_first, profile.given_every);
    out += "\n[tables]\n";
    for (const TableKey& known : kTables) append_table(out, known.key, profile.*known.table);
  }
  for (const TreesKey& known : kTrees) append_trees(out, known.key, profile.*known.trees);
  return out;
}

Result<DensityProfile> parse_density_profile(std::string_view text, const std::string& where) {
  const std::optional<std::string> ascii = escape_non_ascii(text);
  if (!ascii) return Error{ErrorCode::corrupt, where + ": not UTF-8 text"};
  const toml::parse_result parsed = toml::parse(*ascii, where);
  if (!parsed) {
    return Error{ErrorCode::corrupt,
                 fmt::format("{}, line {}: not TOML: {}", where, parsed.error().source().begin.line,
                             parsed.error().description())};
  }
  return read_profile(parsed.table(), where);
}

}  // namespace curlidar
