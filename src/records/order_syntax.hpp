// SPDX-License-Identifier: BSD-3-Clause
// How slots become bits: each either is what a walk over the cells expects, or says what else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "entropy/model.hpp"
#include "records/grid.hpp"
#include "records/numbers.hpp"
#include "records/order.hpp"
#include "records/places.hpp"

namespace curlidar {

/// A walk with the numbers of the records it meets; after the cells come the loose records.
struct WalkRecords {
  static constexpr std::uint32_t kNone = 0xffffffff;

  std::vector<std::uint32_t> cell;    ///< of each place of a cell
  std::vector<std::uint32_t> record;  ///< of each place, kNone where the cell is empty
  std::vector<std::uint8_t> holds;    ///< of each place: 1 if there is a record
  std::size_t records = 0;

  /// `cells` as Walk::cells gives them.
  WalkRecords(std::vector<std::uint32_t> cells, const CellGrid& grid);
  /// The place of each record.
  std::vector<std::uint32_t> places() const;
};

/// Codes all slots of a cloud. Encoder: `order` is given. Decoder: its shape is given, kinds and
/// records are appended.
template <class Coder>
class OrderSyntax {
 public:
  OrderSyntax(Coder& coder, const WalkRecords& walk, std::uint32_t columns)
      : coder_(coder), walk_(walk), places_(walk.holds), columns_(columns) {
    if constexpr (!Coder::kDecodes) place_of_ = walk.places();
    rows_.resize(columns == 0 ? 0 : walk.cell.size() / columns);
  }

  /// Codes `slots` slots until `go_on()` says no. False if it did, or if what was decoded breaks a
  /// rule.
  template <class GoOn>
  bool code(CloudOrder& order, std::uint64_t slots, const GoOn& go_on) {
    period_ = order.height > 1 ? order.width : 0;
    for (std::uint64_t slot = 0; slot < slots; ++slot) {
      if (!go_on()) return false;
      Slot wanted;
      if constexpr (!Coder::kDecodes) wanted = next_slot(order, slot);
      above_ = period_ == 0 || slot < period_                  ? 0
               : order.kind[slot - period_] == SlotKind::point ? 1
                                                               : 2;
      Slot found;
      if (!code_slot(wanted, found)) return false;
      if constexpr (Coder::kDecodes) {
        order.kind.push_back(found.kind);
        if (found.kind == SlotKind::point) order.record.push_back(walk_.record[found.place]);
      }
    }
    return places_.left() == 0;
  }

 private:
  static constexpr std::uint32_t kLimit = 60;
  enum Event : std::uint32_t { kHit, kLoose, kInserted, kJump };

  struct Slot {
    SlotKind kind = SlotKind::point;
    std::size_t place = 0;       ///< of a point
    std::size_t place_then = 0;  ///< of the point after it; encoder only
  };

  /// What is known of a row, each of its last two times.
  struct Row {
    std::uint8_t emitted = 0;  ///< whether its empty cells had slots
    std::uint8_t missed = 0;   ///< whether what was expected after its points did not come
  };

  Slot next_slot(const CloudOrder& order, std::uint64_t slot) {
    Slot wanted{order.kind[slot]};
    if (wanted.kind != SlotKind::point) return wanted;
    wanted.place = place_of_[order.record[points_++]];
    const bool last = points_ == order.record.size();
    wanted.place_then = last ? wanted.place : place_of_[order.record[points_]];
    return wanted;
  }

  bool code_slot(const Slot& wanted, Slot& found) {
    if (code_empty(wanted, found)) return true;
    const bool point = wanted.kind == SlotKind::point;
    if (places_.left() == 0) return code_kind(wanted, found);
    const std::size_t expected = places_.open_from(at_);
    const bool hit = point && wanted.place == expected;
    if (code_bit(coder_, hit_[(history_ * 3 + above_) * 4 + habit()], kLimit, hit)) {
      at_ = expected + 1;
      return take(expected, kHit, found);
    }
    if (code_bit(coder_, inserted_[history_ * 3 + above_], kLimit, !point)) {
      note(kInserted);
      return code_kind(wanted, found);
    }
    const std::size_t loose = places_.first_open(walk_.cell.size());
    if (loose < places_.size() &&
        code_bit(coder_, loose_[history_], kLimit, wanted.place == loose)) {
      return take(loose, kLoose, found);
    }
    return code_jump(expected, wanted, found);
  }

  /// Passes empty cells; true if one of them is the slot.
  bool code_empty(const Slot& wanted, Slot& found) {
    while (places_.left() > 0) {
      const std::size_t place = places_.open_from(at_);
      if (walk_.holds[place] != 0) return false;
      places_.close(place);
      at_ = place + 1;
      std::uint8_t& row = rows_[walk_.cell[place] / columns_].emitted;
      const std::size_t context = (std::size_t{row} * 4 + emitted_) * 3 + above_;
      const bool emitted =
          code_bit(coder_, emits_[context], kLimit, wanted.kind != SlotKind::point);
      row = pushed(row, emitted);
      emitted_ = pushed(emitted_, emitted);
      if (emitted) return code_kind(wanted, found);
    }
    return false;
  }

  bool code_kind(const Slot& wanted, Slot& found) {
    BitModel* models = &kind_[2 * last_kind_];
    found.kind = SlotKind::nan;
    if (!code_bit(coder_, models[0], kLimit, wanted.kind == SlotKind::nan)) {
      const bool zero = code_bit(coder_, models[1], kLimit, wanted.kind == SlotKind::zero);
      found.kind = zero ? SlotKind::zero : SlotKind::odd;
    }
    last_kind_ = static_cast<std::size_t>(found.kind);
    return true;
  }

  /// The record so many records left ahead of or behind the expected one, round the circle. The
  /// walk goes on behind it, or where it was.
  bool code_jump(std::size_t expected, const Slot& wanted, Slot& found) {
    const std::size_t left = places_.left(), here = places_.rank(expected);
    std::size_t ahead = 0;
    bool moves = false;
    if constexpr (!Coder::kDecodes) {
      ahead = (places_.rank(wanted.place) + left - here) % left;
      moves = goes_on_there(expected, wanted);
    }
    moves = code_bit(coder_, moves_, kLimit, moves);
    const bool behind = code_bit(coder_, behind_[moves], kLimit, 2 * ahead > left);
    const std::uint64_t between = jump_[moves].code(coder_, (behind ? left - ahead : ahead) - 1);
    if (between >= left - 1) return false;
    const auto distance = static_cast<std::size_t>(between) + 1;
    ahead = behind ? left - distance : distance;
    const std::size_t place = places_.select((here + ahead) % left);
    if (moves) at_ = place + 1;
    return take(place, kJump, found);
  }

  /// Whether the next point lies nearer behind the wanted one than behind the expected one.
  bool goes_on_there(std::size_t expected, const Slot& wanted) const {
    const auto ahead_of = [&](std::size_t place) {
      return (wanted.place_then + places_.size() - place) % places_.size();
    };
    return ahead_of(wanted.place) < ahead_of(expected);
  }

  bool take(std::size_t place, Event event, Slot& found) {
    places_.take(place);
    found.kind = SlotKind::point;
    found.place = place;
    note(event);
    if (place < walk_.cell.size()) last_row_ = &rows_[walk_.cell[place] / columns_];
    return true;
  }

  /// What came the last two times after a point of the row that the slot before has.
  std::size_t habit() const { return last_row_ != nullptr ? last_row_->missed : 0; }

  void note(Event event) {
    history_ = (history_ << 2 | event) & 63;
    if (last_row_ != nullptr) last_row_->missed = pushed(last_row_->missed, event != kHit);
    last_row_ = nullptr;
  }

  static std::uint8_t pushed(std::uint8_t bits, bool bit) {
    return static_cast<std::uint8_t>((bits << 1 | (bit ? 1 : 0)) & 3);
  }

  Coder& coder_;
  const WalkRecords& walk_;
  Places places_;
  std::uint32_t columns_;
  std::vector<std::uint32_t> place_of_;  ///< encoder only
  std::size_t points_ = 0;               ///< encoder only: points coded

  std::size_t at_ = 0;  ///< where the walk goes on
  std::uint64_t period_ = 0;
  std::size_t history_ = 0;   ///< the last three events
  std::size_t above_ = 0;     ///< the slot above in an organised cloud: unknown, point, other
  std::uint8_t emitted_ = 0;  ///< whether the last two empty cells had slots
  std::vector<Row> rows_;
  Row* last_row_ = nullptr;  ///< of the slot before, if it is a point of a cell
  std::size_t last_kind_ = 0;

  std::array<BitModel, 64 * 3 * 4> hit_;
  std::array<BitModel, 64 * 3> inserted_;
  std::array<BitModel, 64> loose_;
  std::array<BitModel, 4 * 4 * 3> emits_;
  std::array<BitModel, 2 * 4> kind_;
  BitModel moves_;
  std::array<BitModel, 2> behind_;
  std::array<SizeModels, 2> jump_;
};

}  // namespace curlidar
