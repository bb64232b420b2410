// One self-contained HTML page: text, tables and charts. No script, nothing from elsewhere; dark
// and light, printable, readable on a phone.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gyrotwin {

/// How a verdict or a row looks; always said in words too.
enum class Tone : std::uint8_t { kPlain, kGood, kDoubtful, kBad };

/// A page, put together from top to bottom. Texts are plain and get escaped; charts are those of
/// chart.hpp.
class Page {
 public:
  /// @param subtitle one line under the title; empty: none
  Page(const std::string& title, const std::string& subtitle);

  /// A large box with one sentence and its reason.
  void verdict(Tone tone, const std::string& sentence, const std::string& reason);
  void heading(const std::string& text);
  void paragraph(const std::string& text);
  /// A table; columns of numbers stand to the right, headings too. @pre no row longer than header
  /// @param tones of the rows; empty: all plain
  void table(const std::vector<std::string>& header,
             const std::vector<std::vector<std::string>>& rows,
             const std::vector<Tone>& tones = {});
  /// A chart with a caption under it; consecutive ones stand side by side where there is room.
  void figure(const std::string& svg, const std::string& caption);
  /// Text as it is, in a fixed-width box that is folded away.
  void listing(const std::string& summary, const std::string& text);

  std::string html() const;

 private:
  void end_figures();

  std::string title_;
  std::string body_;
  bool in_figures_ = false;
};

}  // namespace gyrotwin
