// SPDX-License-Identifier: BSD-3-Clause
// train_predicted_priors LIST [FOLDER]: reads lines "GROUP FIRST_PATH SECOND_PATH still|moving" of
// scans that follow each other (one sensor or drive a group), codes the second of each from the
// first at several steps, says what fields and masks cost with priors that their own group did not
// teach, and writes predicted_field.txt, predicted_field_mix.txt, predicted_mask.txt and
// predicted_mask_mix.txt, taught by all groups but "test", into FOLDER.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/parallel.hpp"
#include "codec/compact_field.hpp"
#include "codec/predicted.hpp"
#include "compact/field_encoder.hpp"
#include "compact/mask_guide.hpp"
#include "compact/prediction.hpp"
#include "compact/prediction_chunk.hpp"
#include "format/container.hpp"
#include "given_scan.hpp"
#include "priors/train.hpp"

namespace {

using namespace curlidar;
using namespace curlidar::compact;

/// A predicted scan with all that its coder sees. One segment.
struct Lesson {
  std::string name;
  std::unique_ptr<Geometry> geometry;
  Prediction prediction;
  Guide guide;
  MaskShape shape;
  std::vector<std::uint8_t> occupied;
  FieldSettings settings;
  std::vector<Node> roots;
};
using LessonRef = std::shared_ptr<const Lesson>;

struct FieldRoom {
  using Model = FieldModels;
  using Scan = LessonRef;

  Model fresh() const { return FieldModels::blank(true); }
  std::span<BitModel> models(Model& model) const { return model.models; }
  std::vector<std::int32_t> weights(const Model& model) const {
    std::vector<std::int32_t> out;
    for (const auto& mix : model.guided_weights) {
      out.insert(out.end(), mix.weight.begin(), mix.weight.end());
    }
    return out;
  }
  void set_weights(Model& model, std::span<const std::int32_t> weights) const {
    for (std::size_t i = 0; i < weights.size(); ++i) {
      model.guided_weights[i / kGuidedInputs].weight[i % kGuidedInputs] = weights[i];
    }
  }
  template <class Coder>
  void code(Coder& coder, Model& model, const Scan& scan, std::int32_t rate) const {
    FieldState state(*scan->geometry, scan->occupied, scan->settings, &scan->guide);
    MixSink<Coder> sink(coder, model, rate);
    std::vector<Node> roots = scan->roots;
    for (Node& root : roots) code_node(sink, state, root);
  }
};

struct MaskRoom {
  using Model = GuidedMaskModel;
  using Scan = LessonRef;

  Model fresh() const { return Model(); }
  std::span<BitModel> models(Model& model) const { return model.models(); }
  std::vector<std::int32_t> weights(const Model& model) const {
    std::vector<std::int32_t> out;
    for (const auto& set : model.weights()) {
      for (std::size_t i = 0; i < kGuidedMaskInputs; ++i) out.push_back(set.fine(i) >> 4);
    }
    return out;
  }
  void set_weights(Model& model, std::span<const std::int32_t> weights) const {
    for (std::size_t i = 0; i < weights.size(); ++i) {
      model.weights()[i / kGuidedMaskInputs].set(i % kGuidedMaskInputs, weights[i] * 16);
    }
  }
  template <class Coder>
  void code(Coder& coder, Model& model, const Scan& scan, std::int32_t rate) const {
    code_guided_mask(coder, model, MaskHints(scan->guide, scan->shape), scan->shape, rate,
                     scan->occupied.data(), [](std::size_t) { return true; });
  }
};

struct Pair {
  std::string group, first, second;
  bool still = false;
};

/// Steps of training, metres.
constexpr double kSteps_m[] = {1.2, 0.5, 0.25, 0.12};

std::shared_ptr<const PredictionReference> reference_of(const Result<Encoded>& encoded) {
  if (!encoded) return nullptr;
  const auto scan = decode(encoded->bytes);
  if (!scan) return nullptr;
  const auto reference = PredictionReference::of(*scan);
  return reference ? *reference : nullptr;
}

/// What the second scan's coder saw at a step; null if there is no such thing.
LessonRef lesson_of(const Pair& pair, const Cloud& first, const Cloud& second, double step_m) {
  EncodeSettings settings;
  settings.attributes.emplace();
  settings.compact.index = false;
  settings.compact.target = CompactTarget::step;
  settings.compact.target_value = step_m;
  const auto reference = reference_of(encode(first, settings));
  if (!reference) return nullptr;
  const auto encoded = encode_predicted(second, settings, reference, {pair.still, {}});
  if (!encoded) return nullptr;
  DecodeOptions options;
  options.reference = reference;
  options.partition = true;
  const auto scan = decode(encoded->bytes, options);
  const auto chunks = read_container(encoded->bytes);
  if (!scan || !chunks) return nullptr;
  const Chunk* chunk = find_chunk(*chunks, ChunkType::compact_prediction);
  const auto header = read_prediction({ScanPart::prediction, chunk->payload, 0, true});
  const compact::DecodedScan& coded = dynamic_cast<const CompactField&>(*scan->field).scan();
  if (!header || coded.segments.size() != 1) return nullptr;
  auto lesson = std::make_shared<Lesson>();
  const ScanParameters& p = coded.parameters;
  const SegmentPlace whole{0, 0, p.rows, p.columns};
  lesson->name = fmt::format("{} {}", pair.second.substr(pair.second.rfind('/') + 1), step_m);
  lesson->geometry = std::make_unique<Geometry>(geometry_of(coded.table, whole));
  lesson->prediction = predict(reference->scan(), header->pose, coded.table, p.rows, p.columns);
  lesson->guide = guide_of(lesson->prediction, whole);
  lesson->shape = {p.rows, p.columns, coded.table.turn_columns};
  lesson->occupied = coded.occupied;
  lesson->settings = {p.step, p.root_log2, p.smallest_leaf};
  lesson->roots = coded.segments[0].nodes;
  return lesson;
}

using Examples = std::vector<training::Example<LessonRef>>;

template <class Room>
training::Priors taught(const Room& room, const Examples& lessons, std::int32_t rate,
                        const char* what) {
  const training::Trainer<Room> trainer(room, lessons, rate);
  for (const std::string& group : trainer.groups()) {
    const auto priors = trainer.train({group, "test"});
    double blank = 0, trained = 0;
    for (const auto& lesson : lessons) {
      if (lesson.group != group) continue;
      blank += trainer.bits(lesson.scan, room.fresh(), rate);
      trained += trainer.bits(lesson.scan, trainer.start(priors), rate);
    }
    fmt::print("{:6} {:12} blank {:10.0f} bits, taught by others {:10.0f}: {:.3f}\n", what, group,
               blank, trained, trained / blank);
  }
  return trainer.train({"test"});
}

bool write_priors(const std::string& folder, const std::string& name, training::Priors priors) {
  for (std::int32_t& weight : priors.weights) weight = (weight + 8) >> 4;
  return training::write_text(
             folder + "/" + name + ".txt",
             training::format_states(priors.states, "# First states of the models.\n")) &&
         training::write_text(
             folder + "/" + name + "_mix.txt",
             training::format_weights(priors.weights, "# First weights of the mixes.\n"));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: train_predicted_priors LIST [FOLDER]\n";
    return 2;
  }
  std::ifstream list(argv[1]);
  std::vector<Pair> pairs;
  Pair pair;
  for (std::string kind; list >> pair.group >> pair.first >> pair.second >> kind;) {
    pair.still = kind == "still";
    pairs.push_back(pair);
  }
  constexpr std::size_t steps = std::size(kSteps_m);
  std::vector<LessonRef> found(pairs.size() * steps);
  parallel_for(found.size(), 0, [&](std::size_t i) {
    const Pair& of = pairs[i / steps];
    const auto first = bench::given_scan(of.first), second = bench::given_scan(of.second);
    if (first && second) found[i] = lesson_of(of, *first, *second, kSteps_m[i % steps]);
    std::cerr << (found[i] ? '.' : 'x') << std::flush;
  });
  Examples lessons;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i]) lessons.push_back({pairs[i / steps].group, found[i]});
  }
  const training::Priors field = taught(FieldRoom{}, lessons, kFieldMixRate, "field");
  // A mask is the same at every error but for what is expected of it.
  const training::Priors mask = taught(MaskRoom{}, lessons, kMaskLearning[0].rate, "mask");
  if (argc < 3) return 0;
  const bool written = write_priors(argv[2], "predicted_field", field) &&
                       write_priors(argv[2], "predicted_mask", mask);
  if (!written) std::cerr << argv[2] << ": cannot write\n";
  return written ? 0 : 1;
}
