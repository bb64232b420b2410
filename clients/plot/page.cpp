#include "clients/plot/page.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>

#include "clients/plot/canvas.hpp"

namespace gyrotwin {

namespace {

constexpr const char* kStyle = R"css(
:root{color-scheme:light dark;--ink:#1b1f24;--soft:#59636e;--line:#d9dee4;--back:#f4f6f8;--card:#fff;
--good:#0b6e4f;--doubt:#8a5a00;--bad:#b3380f}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9ec;--soft:#9aa5b1;--line:#30363d;--back:#0d1117;
--card:#14181d;--good:#4fd1a1;--doubt:#f2b134;--bad:#ff8c5a}}
*{box-sizing:border-box}
body{margin:0;background:var(--back);color:var(--ink);font:16px/1.5 system-ui,-apple-system,"Segoe UI",
sans-serif}
main{max-width:1180px;margin:0 auto;padding:28px 20px 60px}
h1{font-size:28px;line-height:1.2;margin:0}
.sub{color:var(--soft);margin:4px 0 20px}
h2{font-size:19px;margin:36px 0 10px}
p{max-width:78ch}
.verdict{background:var(--card);border:1px solid var(--line);border-left:8px solid var(--soft);
border-radius:8px;padding:16px 20px}
.verdict+.verdict{margin-top:10px}
.verdict b{display:block;font-size:21px;line-height:1.35}
.verdict.good{border-left-color:var(--good)}.verdict.good b{color:var(--good)}
.verdict.doubt{border-left-color:var(--doubt)}.verdict.doubt b{color:var(--doubt)}
.verdict.bad{border-left-color:var(--bad)}.verdict.bad b{color:var(--bad)}
.figures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,480px),1fr));gap:18px}
figure{margin:0;background:var(--card);border:1px solid var(--line);border-radius:8px;padding:10px}
figure svg{display:block;width:100%;height:auto}
figcaption{color:var(--soft);font-size:14px;padding:6px 8px 4px}
.scroll{overflow-x:auto;background:var(--card);border:1px solid var(--line);border-radius:8px}
table{border-collapse:collapse;width:100%;font-size:14.5px}
th,td{text-align:left;padding:6px 12px;border-bottom:1px solid var(--line);vertical-align:top}
th{color:var(--soft);font-weight:600;white-space:nowrap}
tr:last-child td{border-bottom:0}
.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
tr.good td:first-child{color:var(--good);font-weight:600}
tr.doubt td:first-child{color:var(--doubt);font-weight:600}
tr.bad td:first-child{color:var(--bad);font-weight:600}
details{margin-top:14px}summary{cursor:pointer;color:var(--soft)}
pre{overflow-x:auto;background:var(--card);border:1px solid var(--line);border-radius:8px;
padding:12px;font-size:13px}
@media print{body{background:#fff}main{max-width:none;padding:0}figure,.scroll,.verdict{
break-inside:avoid}}
)css";

constexpr std::array<const char*, 4> kClasses{"", "good", "doubt", "bad"};

const char* class_of(Tone tone) { return kClasses[static_cast<std::size_t>(tone)]; }

bool number(const std::string& cell) {
  const bool digits =
      std::any_of(cell.begin(), cell.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  return digits && cell.find_first_not_of("0123456789+-.eE%x, ") == std::string::npos;
}

/// Whether more of a column's cells are numbers than words.
bool numeric(const std::vector<std::vector<std::string>>& rows, std::size_t column) {
  int more = 0;
  for (const auto& row : rows) {
    if (column < row.size() && !row[column].empty()) more += number(row[column]) ? 1 : -1;
  }
  return more > 0;
}

/// Escaped, and what stands between `backticks` as code; one without a partner stays.
std::string prose(const std::string& text) {
  std::string html;
  std::size_t at = 0;
  while (true) {
    const std::size_t open = text.find('`', at);
    const std::size_t close = open == std::string::npos ? open : text.find('`', open + 1);
    if (close == std::string::npos) return html + escaped(text.substr(at));
    html += escaped(text.substr(at, open - at)) + "<code>" +
            escaped(text.substr(open + 1, close - open - 1)) + "</code>";
    at = close + 1;
  }
}

}  // namespace

Page::Page(const std::string& title, const std::string& subtitle) : title_(title) {
  body_ = fmt::format("<h1>{}</h1>\n", escaped(title));
  if (!subtitle.empty()) body_ += fmt::format("<p class='sub'>{}</p>\n", escaped(subtitle));
}

void Page::end_figures() {
  if (in_figures_) body_ += "</div>\n";
  in_figures_ = false;
}

void Page::verdict(Tone tone, const std::string& sentence, const std::string& reason) {
  end_figures();
  body_ += fmt::format("<div class='verdict {}'><b>{}</b>{}</div>\n", class_of(tone),
                       prose(sentence), prose(reason));
}

void Page::heading(const std::string& text) {
  end_figures();
  body_ += fmt::format("<h2>{}</h2>\n", escaped(text));
}

void Page::paragraph(const std::string& text) {
  end_figures();
  body_ += fmt::format("<p>{}</p>\n", prose(text));
}

void Page::table(const std::vector<std::string>& header,
                 const std::vector<std::vector<std::string>>& rows,
                 const std::vector<Tone>& tones) {
  end_figures();
  body_ += "<div class='scroll'><table>\n<thead><tr>";
  std::vector<const char*> classes;
  for (std::size_t column = 0; column < header.size(); ++column) {
    classes.push_back(numeric(rows, column) ? " class='n'" : "");
    body_ += fmt::format("<th{}>{}</th>", classes.back(), escaped(header[column]));
  }
  body_ += "</tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    body_ += fmt::format("<tr class='{}'>", i < tones.size() ? class_of(tones[i]) : "");
    assert(rows[i].size() == header.size());
    for (std::size_t column = 0; column < rows[i].size(); ++column) {
      body_ += fmt::format("<td{}>{}</td>", classes[column], escaped(rows[i][column]));
    }
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void Page::figure(const std::string& svg, const std::string& caption) {
  if (!in_figures_) body_ += "<div class='figures'>\n";
  in_figures_ = true;
  body_ += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", svg, prose(caption));
}

void Page::listing(const std::string& summary, const std::string& text) {
  end_figures();
  body_ += fmt::format("<details><summary>{}</summary><pre>{}</pre></details>\n", escaped(summary),
                       escaped(text));
}

std::string Page::html() const {
  return fmt::format(
      "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'>\n<meta name='viewport' "
      "content='width=device-width,initial-scale=1'>\n<title>{}</title>\n<style>{}</style></head>\n"
      "<body><main>\n{}{}</main></body></html>\n",
      escaped(title_), kStyle, body_, in_figures_ ? "</div>\n" : "");
}

}  // namespace gyrotwin
