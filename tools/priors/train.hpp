// SPDX-License-Identifier: BSD-3-Clause
// Training of any coder's priors: states of models, then weights that suit them.
//
// A Room is a coder seen from here:
//   using Model, using Scan;
//   Model fresh() const;                              // knows nothing
//   std::span<BitModel> models(Model&) const;
//   std::vector<std::int32_t> weights(const Model&) const;          // in 1/65536
//   void set_weights(Model&, std::span<const std::int32_t>) const;
//   template <class Coder> void code(Coder&, Model&, const Scan&, std::int32_t rate) const;
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "priors/fit.hpp"

namespace curlidar::training {

/// Scans of one group (a sensor, a drive) resemble each other: what one teaches is tested on
/// others.
template <class Scan>
struct Example {
  std::string group;
  Scan scan;
};

struct Priors {
  std::vector<FirstState> states;
  std::vector<std::int32_t> weights;  ///< in 1/65536
};

template <class Room>
class Trainer {
 public:
  using Scan = typename Room::Scan;

  /// `rate` is the one at which files will be coded.
  Trainer(Room room, std::vector<Example<Scan>> examples, std::int32_t rate)
      : room_(std::move(room)), examples_(std::move(examples)), rate_(rate) {
    for (const auto& example : examples_) {
      typename Room::Model model = room_.fresh();
      CountingCoder coder(room_.models(model));
      room_.code(coder, model, example.scan, rate_);
      counts_.push_back(coder.counts());
      groups_.insert(example.group);
    }
    for (const std::string& group : groups_) without_[group] = fit_states({group});
  }

  const std::set<std::string>& groups() const { return groups_; }

  /// Priors from all examples but those of the given groups. Weights learn scan after scan, each
  /// with states that its own group did not teach, else they would trust them too much; the mean
  /// over the last round is the result.
  Priors train(const std::set<std::string>& left_out) const {
    const Priors priors{fit_states(left_out), {}};
    typename Room::Model model = room_.fresh();
    std::vector<double> mean;
    for (const std::int32_t rate : {2 * rate_, rate_, std::max(rate_ / 2, 1)}) {
      mean.assign(room_.weights(model).size(), 0.0);
      std::size_t seen = 0;
      for (const std::size_t e : shuffled()) {
        const auto& [group, scan] = examples_[e];
        if (left_out.contains(group)) continue;
        apply_states(without_.at(group), room_.models(model));
        CountingCoder coder(room_.models(model));
        room_.code(coder, model, scan, rate);
        const auto weights = room_.weights(model);
        for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += weights[i];
        ++seen;
      }
      std::vector<std::int32_t> weights;
      for (const double sum : mean) {
        weights.push_back(static_cast<std::int32_t>(
            std::lround(sum / static_cast<double>(std::max<std::size_t>(seen, 1)))));
      }
      room_.set_weights(model, weights);
    }
    return {priors.states, room_.weights(model)};
  }

  typename Room::Model start(const Priors& priors) const {
    typename Room::Model model = room_.fresh();
    apply_states(priors.states, room_.models(model));
    room_.set_weights(model, priors.weights);
    return model;
  }

  /// Bits of a scan coded from a given start.
  double bits(const Scan& scan, typename Room::Model model, std::int32_t rate) const {
    CountingCoder coder(room_.models(model));
    room_.code(coder, model, scan, rate);
    return coder.bits();
  }

 private:
  std::vector<FirstState> fit_states(const std::set<std::string>& left_out) const {
    std::map<std::string, std::size_t> sizes;
    for (const auto& example : examples_) ++sizes[example.group];
    std::vector<double> weights;
    for (const auto& example : examples_) {
      const double size = static_cast<double>(sizes[example.group]);
      // A group of many scans counts for more, but only as the root of their number.
      weights.push_back(left_out.contains(example.group) ? 0.0
                                                         : std::min(1.0, std::sqrt(8 / size)));
    }
    return fit_first_states(counts_, weights);
  }

  /// An order that mixes the groups, the same on every machine.
  std::vector<std::size_t> shuffled() const {
    std::vector<std::size_t> order(examples_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto key = [](std::size_t i) {
      return static_cast<std::uint32_t>(i + 1) * 2654435761u % 1000003u;
    };
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    return order;
  }

  Room room_;
  std::vector<Example<Scan>> examples_;
  std::int32_t rate_;
  std::vector<BitCounts> counts_;
  std::set<std::string> groups_;
  std::map<std::string, std::vector<FirstState>> without_;
};

}  // namespace curlidar::training
