// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "codec/compact_model.hpp"
#include "codec/predicted.hpp"
#include "compact/prediction.hpp"

namespace curlidar {

/// What a scan is to be predicted from.
struct PredictionSource {
  std::shared_ptr<const PredictionReference> reference;
  PredictionGuess guess;
};

/// What is expected of a model's image, and what its file says of that.
struct PredictedModel {
  compact::Prediction prediction;
  compact::PredictionHeader header;
};

/// Gives the model the rows of the reference where that makes no difference to its points, finds
/// the motion, and predicts.
PredictedModel predict_model(const PredictionSource& source, CompactModel& model);

/// The range offsets of the reference, if its rows and the model's are the same otherwise.
bool share_rows(const compact::RowTable& reference, compact::RowTable& table);

}  // namespace curlidar
