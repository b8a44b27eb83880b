// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/try.hpp"
#include "codec/sequence_group.hpp"
#include "codec/sequence_parts.hpp"
#include "curlidar/sequence.hpp"
#include "format/container.hpp"
#include "format/indexed_file.hpp"
#include "io/random_access.hpp"

namespace curlidar {
namespace {

constexpr std::size_t kChecksumSize = 4;
/// First bytes that tell what a file is.
constexpr std::uint64_t kFirstBytes = 64;

std::string scans_text(std::uint64_t first, std::uint64_t scans) {
  if (scans == 0) return "an unknown number of scans";
  return scans == 1 ? fmt::format("scan {}", first)
                    : fmt::format("scans {} to {}", first, first + scans - 1);
}

/// Groups one after the other in the order of the file, by what their own heads say.
class GroupRow {
 public:
  void add_damaged(std::uint64_t bytes) {
    SequencePart part;
    part.first_scan = scans_;
    part.bytes = bytes;
    groups_.push_back(part);
    damaged_bytes_ += bytes;
  }
  /// False if its scans cannot follow those before: numbers between them are those of damaged
  /// groups, which have no more scans than bytes.
  bool add(const SequenceGroup& group, std::uint64_t bytes) {
    const std::uint64_t first = group.first_scan;
    if (first < scans_ || first - scans_ > damaged_bytes_) return false;
    if (group.scans.empty() || group.scans.size() > kMaxSequenceGroup) return false;
    if (first > scans_) groups_.back().scans = first - scans_;
    SequencePart part;
    part.first_scan = first;
    part.scans = group.scans.size();
    for (const GroupScan& scan : group.scans) part.returns += scan.returns;
    part.bytes = bytes;
    part.time_s = group.scans.front().stamp.time_s;
    groups_.push_back(part);
    scans_ = first + part.scans;
    damaged_bytes_ = 0;
    return true;
  }
  std::vector<SequencePart>& groups() { return groups_; }

 private:
  std::vector<SequencePart> groups_;
  std::uint64_t scans_ = 0;
  std::uint64_t damaged_bytes_ = 0;  ///< since the last group that is whole
};

}  // namespace

struct SequenceFile::State {
  IndexedFile file;
  std::shared_ptr<const RandomAccess> source;
  SequenceReadOptions options;
  SequenceHead head;
  std::vector<SequencePart> groups;
  std::vector<std::string> missing;
  std::optional<std::vector<std::byte>> torn;  ///< the last group, cut off

  // The group that was read last, and how far it is decoded.
  std::optional<std::size_t> open_group;
  std::vector<std::byte> open_bytes;
  SequenceGroup group;
  SequenceDecoder decoder;
  std::size_t next = 0;  ///< frame that the decoder takes next

  Status take_index();
  Status walk();
  void take_torn_part(GroupRow& row);
  Status load(std::size_t group_index);
  std::size_t group_of(std::uint64_t scan) const;
  Result<std::vector<std::byte>> bytes_of(std::size_t group_index) const;
  ByteSpan frame(std::size_t in_group) const {
    return ByteSpan(open_bytes).subspan(group.scans[in_group].offset, group.scans[in_group].bytes);
  }
};

/// Where the groups are, by the index.
Status SequenceFile::State::take_index() {
  std::uint64_t scans = 0;
  for (const IndexedEntry& entry : file.entries()) {
    CURLIDAR_TRY_ASSIGN(part, read_group_summary(entry.summary));
    if (part.scans > entry.size) {
      return Error{
          ErrorCode::corrupt,
          fmt::format("the index tells {} scans in a group of {} bytes", part.scans, entry.size)};
    }
    part.first_scan = scans;
    part.bytes = entry.size;
    scans += part.scans;
    groups.push_back(part);
  }
  return {};
}

/// Where the groups are, by their own heads.
Status SequenceFile::State::walk() {
  GroupRow row;
  for (std::size_t i = 0; i < file.entries().size(); ++i) {
    const std::uint64_t size = file.entries()[i].size;
    const auto bytes = file.read(i);
    if (!bytes && bytes.error().code == ErrorCode::io) return bytes.error();
    const auto read = bytes ? read_group(*bytes) : Result<SequenceGroup>(bytes.error());
    if (!read || !row.add(*read, size)) row.add_damaged(size);
  }
  missing.push_back(file.missing().value_or("its end"));
  take_torn_part(row);
  groups = std::move(row.groups());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i].scans > 0) continue;
    missing.push_back(fmt::format("the scans of group {}, which is damaged", i));
  }
  return {};
}

/// The group that the file was cut off in, if scans of it are whole.
void SequenceFile::State::take_torn_part(GroupRow& row) {
  const std::uint64_t at = file.parts_end();
  if (at >= source->size()) return;
  const auto bytes =
      source->read(at, std::min(source->size() - at, IndexedLimits{}.max_part_bytes));
  if (!bytes) return;
  ByteReader reader(*bytes);
  const auto type = static_cast<ChunkType>(reader.read<std::uint8_t>());
  const std::uint64_t size = reader.read_varint();
  const bool cut = reader.ok() && type == ChunkType::indexed_part &&
                   size > reader.remaining() - std::min(reader.remaining(), kChecksumSize);
  if (!cut) return;
  const ByteSpan left = reader.take(std::min<std::uint64_t>(size, reader.remaining()));
  const auto read = read_group(left, true);
  if (!read || !row.add(*read, left.size())) return;
  torn.emplace(left.begin(), left.end());
  missing.push_back(fmt::format("{} of the group that it was cut off in",
                                scans_text(read->first_scan + read->scans.size(), read->lost)));
}

Result<std::vector<std::byte>> SequenceFile::State::bytes_of(std::size_t group_index) const {
  if (torn && group_index == file.entries().size()) return *torn;
  return file.read(group_index);
}

/// Reads a group unless it is the one that is open.
Status SequenceFile::State::load(std::size_t group_index) {
  if (open_group == group_index) return {};
  open_group.reset();
  next = 0;
  const SequencePart& told = groups[group_index];
  const auto lost = [&](const Error& error) {
    if (error.code == ErrorCode::io) return error;
    return Error{error.code,
                 fmt::format("group {} with {} is damaged, others are not touched by it: {}",
                             group_index, scans_text(told.first_scan, told.scans), error.message)};
  };
  auto bytes = bytes_of(group_index);
  if (!bytes) return lost(bytes.error());
  auto read = read_group(*bytes, torn && group_index == file.entries().size());
  if (!read) return lost(read.error());
  if (read->first_scan != told.first_scan || read->scans.size() != told.scans) {
    return lost({ErrorCode::corrupt, "it holds other scans than its place in the file tells"});
  }
  open_bytes = *std::move(bytes);
  group = *std::move(read);
  open_group = group_index;
  return {};
}

/// The group that a scan is in; the number of groups if it is in none.
std::size_t SequenceFile::State::group_of(std::uint64_t scan) const {
  const auto after = std::upper_bound(
      groups.begin(), groups.end(), scan,
      [](std::uint64_t wanted, const SequencePart& part) { return wanted < part.first_scan; });
  return after == groups.begin() ? groups.size()
                                 : static_cast<std::size_t>(after - groups.begin()) - 1;
}

SequenceFile::SequenceFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
SequenceFile::SequenceFile(SequenceFile&&) noexcept = default;
SequenceFile& SequenceFile::operator=(SequenceFile&&) noexcept = default;
SequenceFile::~SequenceFile() = default;

Result<SequenceFile> SequenceFile::open(std::shared_ptr<const RandomAccess> source,
                                        const SequenceReadOptions& options) {
  IndexedOptions indexed;
  indexed.allow_truncated = options.allow_truncated;
  CURLIDAR_TRY_ASSIGN(file, IndexedFile::open(source, indexed));
  if (file.kind() != IndexedKind::sequence) {
    return Error{ErrorCode::unsupported, fmt::format("{}: the file is a {}, not a sequence",
                                                     source->name(), to_string(file.kind()))};
  }
  const auto named = [&](const Error& error) {
    return Error{error.code, fmt::format("{}: {}", source->name(), error.message)};
  };
  auto head = read_sequence_head(file.header());
  if (!head) return named(head.error());
  auto state = std::make_unique<State>(State{std::move(file),
                                             source,
                                             options,
                                             *head,
                                             {},
                                             {},
                                             {},
                                             {},
                                             {},
                                             {},
                                             SequenceDecoder(options.limits, options.threads),
                                             0});
  const Status status = state->file.missing() ? state->walk() : state->take_index();
  if (!status) return named(status.error());
  return SequenceFile(std::move(state));
}

Result<SequenceFile> SequenceFile::open(const std::string& path,
                                        const SequenceReadOptions& options) {
  CURLIDAR_TRY_ASSIGN(source, open_random_access(path));
  return open(std::move(source), options);
}

Result<SequenceFile> SequenceFile::parse(std::vector<std::byte> bytes, const std::string& name,
                                         const SequenceReadOptions& options) {
  return open(random_access_of(std::move(bytes), name), options);
}

std::size_t SequenceFile::scans() const {
  const auto& groups = state_->groups;
  return groups.empty() ? 0
                        : static_cast<std::size_t>(groups.back().first_scan + groups.back().scans);
}

std::uint64_t SequenceFile::bytes() const {
  return state_->file.file_bytes();
}

std::uint32_t SequenceFile::group_size() const {
  return state_->head.group;
}

bool SequenceFile::still() const {
  return state_->head.still;
}

const std::vector<SequencePart>& SequenceFile::groups() const {
  return state_->groups;
}

const std::vector<std::string>& SequenceFile::missing() const {
  return state_->missing;
}

Result<SequenceScan> SequenceFile::scan(std::size_t index) {
  if (index >= scans()) {
    return Error{ErrorCode::invalid_argument,
                 fmt::format("there is no scan {}: the sequence has {}", index, scans())};
  }
  const std::size_t group = state_->group_of(index);
  CURLIDAR_TRY(state_->load(group));
  const std::uint64_t in_group = index - state_->groups[group].first_scan;
  if (in_group >= state_->group.scans.size()) {
    return Error{ErrorCode::corrupt, fmt::format("scan {} lies in a group that is lost", index)};
  }
  const GroupScan& scan = state_->group.scans[static_cast<std::size_t>(in_group)];
  return SequenceScan{scan.kind, group, scan.bytes, scan.returns, scan.stamp};
}

Result<DecodedScan> SequenceFile::decode(std::size_t index, const DecodeOptions& options) {
  CURLIDAR_TRY(scan(index));  // opens its group
  State& state = *state_;
  const auto wanted = static_cast<std::size_t>(index - state.groups[*state.open_group].first_scan);
  if (wanted < state.next) state.next = 0;
  // Scans that no later one needs are passed over.
  std::size_t start = wanted;
  while (start > state.next && state.group.scans[start].kind == FrameKind::predicted) --start;
  for (; state.next < wanted; ++state.next) {
    const ByteSpan frame = state.frame(state.next);
    Status before;
    if (state.next < start) {
      before = state.decoder.skip(frame);
    } else if (const auto decoded = state.decoder.add(frame); !decoded) {
      before = decoded.error();
    }
    if (before) continue;
    const std::size_t failed = std::exchange(state.next, 0);
    return Error{
        before.error().code,
        fmt::format("scan {}, which it needs, cannot be decoded: {}",
                    state.groups[*state.open_group].first_scan + failed, before.error().message)};
  }
  auto decoded = state.decoder.add(state.frame(wanted), options);
  state.next = decoded ? wanted + 1 : 0;
  return decoded;
}

bool is_sequence(std::span<const std::byte> bytes) {
  return indexed_kind(bytes) == IndexedKind::sequence;
}

bool is_sequence_file(const std::string& path) {
  const auto source = open_random_access(path);
  if (!source) return false;
  const auto first = (*source)->read(0, std::min((*source)->size(), kFirstBytes));
  return first && is_sequence(*first);
}

}  // namespace curlidar
