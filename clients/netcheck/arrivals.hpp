// Which of a sender's numbered messages have come: once, again, or after a later one.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>

namespace gyrotwin::netcheck {

/// Counts numbers that begin at 0. What was sent minus distinct() is lost.
class Arrivals {
 public:
  /// How far behind the newest a number may be and still be told from a repeat.
  static constexpr std::int64_t kWindow = 65'536;

  /// @param number not negative. @return whether it has come for the first time; what is kWindow
  /// behind counts as a repeat
  bool hear(std::int64_t number) noexcept {
    if (number > newest_) {
      forget_between(newest_, number);
      newest_ = number;
    } else if (number <= newest_ - kWindow || heard_[slot(number)]) {
      ++repeats_;
      return false;
    } else {
      ++late_;
    }
    heard_[slot(number)] = true;
    ++distinct_;
    return true;
  }

  std::int64_t distinct() const noexcept { return distinct_; }
  std::int64_t repeats() const noexcept { return repeats_; }
  std::int64_t late() const noexcept { return late_; }

 private:
  static std::size_t slot(std::int64_t number) noexcept {
    return static_cast<std::size_t>(number % kWindow);
  }
  /// The window moves on from `old` to `next`; nothing between them has come.
  void forget_between(std::int64_t old, std::int64_t next) noexcept {
    if (old < next - kWindow) {
      heard_.reset();
      return;
    }
    for (std::int64_t n = old + 1; n < next; ++n) heard_[slot(n)] = false;
  }

  std::bitset<kWindow> heard_;
  std::int64_t newest_ = -1;
  std::int64_t distinct_ = 0, repeats_ = 0, late_ = 0;
};

}  // namespace gyrotwin::netcheck
