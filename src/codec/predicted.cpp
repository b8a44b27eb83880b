// SPDX-License-Identifier: BSD-3-Clause
#include "codec/predicted.hpp"

#include <utility>

#include "base/try.hpp"
#include "codec/compact_encode.hpp"
#include "codec/compact_field.hpp"
#include "codec/pose_search.hpp"
#include "codec/predicted_image.hpp"
#include "compact/prediction_chunk.hpp"

namespace curlidar {

Result<std::shared_ptr<const PredictionReference>> PredictionReference::of(
    const DecodedScan& scan) {
  const auto* field = dynamic_cast<const CompactField*>(scan.field.get());
  if (field == nullptr || !field->scan().missing.empty()) {
    return Error{ErrorCode::unsupported,
                 "only whole scans of the compact profile with an image can be predicted from"};
  }
  auto out = std::make_shared<PredictionReference>();
  out->field_ = scan.field;
  out->scan_ = &field->scan();
  return std::shared_ptr<const PredictionReference>(std::move(out));
}

bool share_rows(const compact::RowTable& reference, compact::RowTable& table) {
  if (reference.rays.has_value() != table.rays.has_value() ||
      reference.elevation != table.elevation || reference.height != table.height) {
    return false;
  }
  if (table.rays) {
    const compact::RayTable &a = *reference.rays, &b = *table.rays;
    if (a.slots != b.slots || a.rays != b.rays || a.range_unit_q48 != b.range_unit_q48 ||
        a.table != b.table) {
      return false;
    }
  }
  compact::RowTable shared = reference;
  shared.turn_columns = table.turn_columns;
  shared.first_column = table.first_column;
  if (table.rays) {
    shared.rays->firings = table.rays->firings;
    shared.rays->motion = table.rays->motion;
    shared.rays->turn_shift = table.rays->turn_shift;
    shared.rays->move_shift = table.rays->move_shift;
  }
  table = std::move(shared);
  return true;
}

PredictedModel predict_model(const PredictionSource& source, CompactModel& model) {
  const compact::DecodedScan& reference = source.reference->scan();
  PredictedModel out;
  out.header.reference = fingerprint_of(reference);
  out.header.same_rows = share_rows(reference.table, model.table);
  out.header.same_firings = out.header.same_rows && model.table == reference.table;
  if (!source.guess.still) {
    std::vector<RigidMotion> guesses(1);
    if (source.guess.motion) guesses.insert(guesses.begin(), *source.guess.motion);
    out.header.pose = find_pose(reference, model, guesses);
  }
  out.prediction =
      predict(reference, out.header.pose, model.table, model.image.rows, model.image.columns);
  return out;
}

Result<Encoded> encode_predicted(const Cloud& cloud, const EncodeSettings& settings,
                                 const std::shared_ptr<const PredictionReference>& reference,
                                 const PredictionGuess& guess, const ProgressCallback& progress) {
  if (settings.profile != Profile::compact) {
    return Error{ErrorCode::unsupported, "only scans of the compact profile are predicted"};
  }
  const PredictionSource source{reference, guess};
  return encode_compact(cloud, settings, progress, &source);
}

}  // namespace curlidar
