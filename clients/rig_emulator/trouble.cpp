#include "clients/rig_emulator/trouble.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "services/runtime/error.hpp"
#include "services/runtime/spelling.hpp"

namespace gyrotwin {

namespace {

using Kind = Trouble::Kind;

constexpr double kLongest = 1e6;  // [s]

constexpr std::array kWords{
    TroubleWord{Kind::kSilent, "silent", "nothing passes the line, either way"},
    TroubleWord{Kind::kHalves, "halves", "every frame ends somewhere in its middle, both ways"},
    TroubleWord{Kind::kFlips, "flips", "bits flip on the line: =SHARE of its bytes are hit"},
    TroubleWord{Kind::kDeaf, "deaf", "the device does not read what the host sends"},
    TroubleWord{Kind::kRestart, "restart", "the firmware starts anew; the plant goes on"},
    TroubleWord{Kind::kEstop, "estop", "the E-stop is pressed, and then released"},
};

const TroubleWord& word_of(std::string_view name, std::string_view text) {
  const auto* word = std::find_if(kWords.begin(), kWords.end(),
                                  [name](const TroubleWord& w) { return w.name == name; });
  if (word != kWords.end()) return *word;
  std::vector<std::string_view> names;
  std::string list;
  for (const TroubleWord& w : kWords) {
    names.push_back(w.name);
    list += fmt::format("{}{}", list.empty() ? "" : ", ", w.name);
  }
  throw Error(fmt::format("trouble `{}`: there is no `{}`; there are {}{}", text, name, list,
                          did_you_mean(nearest(name, names))));
}

/// The number that begins `text`, which is moved on behind it.
double number(std::string_view& text, std::string_view whole, double highest) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !(value >= 0.0 && value <= highest)) {
    throw Error(fmt::format("trouble `{}`: `{}` must begin with a number from 0 to {:g}", whole,
                            text, highest));
  }
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

}  // namespace

std::span<const TroubleWord> trouble_words() { return kWords; }

Trouble parse_trouble(std::string_view text, double now) {
  std::string_view rest = text;
  const std::size_t name_end = std::min(rest.find_first_of("@+="), rest.size());
  Trouble trouble{.kind = word_of(rest.substr(0, name_end), text).kind, .at_s = now};
  rest.remove_prefix(name_end);
  const auto take = [&rest](char sign) {
    if (rest.empty() || rest.front() != sign) return false;
    rest.remove_prefix(1);
    return true;
  };
  if (take('@')) trouble.at_s = number(rest, text, kLongest);
  if (take('+')) trouble.duration_s = number(rest, text, kLongest);
  const bool shared = take('=');
  if (shared) trouble.share = number(rest, text, 1.0);
  if (!rest.empty()) {
    throw Error(fmt::format("trouble `{}`: what is `{}`? It takes KIND[@AT][+DURATION][=SHARE]",
                            text, rest));
  }
  if (shared != (trouble.kind == Kind::kFlips)) {
    throw Error(
        fmt::format("trouble `{}`: flips take =SHARE, from 0 to 1, and no other does", text));
  }
  if (trouble.kind == Kind::kRestart && trouble.duration_s) {
    throw Error(fmt::format("trouble `{}`: a restart has no duration", text));
  }
  return trouble;
}

}  // namespace gyrotwin
