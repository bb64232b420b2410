#include "services/schema/lcm_source.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

constexpr std::size_t kLargestDimension = 1 << 20;
constexpr std::size_t kMostDimensions = 8;

bool in_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
}

std::string quoted(std::string_view text) { return std::string(1, '`').append(text).append("`"); }

/// Words, single characters and line comments, one at a time.
class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  /// The next word or character, comments passed over; empty at the end.
  std::string_view next() {
    while (skip_blank() || skip_comment()) {
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && in_word(text_[at_])) ++at_;
    if (at_ == begin && at_ < text_.size()) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  /// What a `//` says on the rest of this line; empty without one.
  std::string_view comment() const {
    const std::string_view rest = text_.substr(at_, text_.find('\n', at_) - at_);
    const std::size_t begin = rest.find("//");
    if (begin == std::string_view::npos) return {};
    const std::size_t first = rest.find_first_not_of(' ', begin + 2);
    return first == std::string_view::npos ? std::string_view() : rest.substr(first);
  }

  void expect(std::string_view wanted) {
    const std::string_view found = next();
    if (found != wanted) refuse(quoted(wanted), found);
  }

  [[noreturn]] void refuse(const std::string& wanted, std::string_view found) const {
    const auto line =
        1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    throw Error("line " + std::to_string(line) + ": expected " + wanted + ", found " +
                (found.empty() ? "the end" : quoted(found)));
  }

 private:
  bool skip_blank() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return at_ > begin;
  }
  bool skip_comment() {
    const std::string_view start = text_.substr(at_, 2);
    if (start != "//" && start != "/*") return false;
    const std::string_view last = start == "//" ? "\n" : "*/";
    const std::size_t end = text_.find(last, at_ + 2);
    at_ = end == std::string_view::npos ? text_.size() : end + last.size();
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

std::string name(Lexer& lexer, const std::string& what) {
  const std::string_view word = lexer.next();
  if (word.empty() || !in_word(word.front())) lexer.refuse(what, word);
  return std::string(word);
}

void skip_to(Lexer& lexer, std::string_view last) {
  for (std::string_view word = lexer.next(); word != last; word = lexer.next()) {
    if (word.empty()) lexer.refuse(quoted(last), word);
  }
}

/// A dimension; empty when its length is another member's value.
std::optional<std::size_t> dimension(Lexer& lexer) {
  const std::string word = name(lexer, "a length");
  lexer.expect("]");
  std::size_t length = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), length);
  if (end == word.data()) return {};
  if (error != std::errc() || end != word.data() + word.size() || length < 1 ||
      length > kLargestDimension) {
    lexer.refuse("a length from 1 to " + std::to_string(kLargestDimension), word);
  }
  return length;
}

/// The members that one type names: `double x[3], y;`
void parse_members(Lexer& lexer, std::string_view type, LcmStruct& into) {
  const std::size_t first = into.members.size();
  const std::string_view bare = type.substr(type.rfind('.') + 1);
  if (bare == "string") into.one_size = false;
  std::string_view word;
  do {
    LcmMember& member = into.members.emplace_back(
        LcmMember{std::string(bare), name(lexer, "a name"), {}, {}, false});
    for (word = lexer.next(); word == "["; word = lexer.next()) {
      if (member.dimensions.size() == kMostDimensions) lexer.refuse("fewer dimensions", word);
      const auto length = dimension(lexer);
      into.one_size = into.one_size && length;
      member.dimensions.push_back(length.value_or(0));
    }
  } while (word == ",");
  if (word != ";") lexer.refuse("`;`", word);
  const std::string_view comment = lexer.comment();
  for (std::size_t i = first; i < into.members.size(); ++i) {
    into.members[i].comment = comment;
    into.members[i].is_text = comment.find("ASCII") != std::string_view::npos;
  }
}

/// `const int32_t A = 1, B = 2;`, behind `const`.
void parse_constants(Lexer& lexer, LcmStruct& into) {
  const std::string type = name(lexer, "a type");
  std::string_view word;
  do {
    LcmConstant constant{.type = type, .name = name(lexer, "a name"), .value = {}};
    lexer.expect("=");
    for (word = lexer.next(); word != "," && word != ";"; word = lexer.next()) {
      if (word.empty()) lexer.refuse("`;`", word);
      constant.value += word;
    }
    into.constants.push_back(std::move(constant));
  } while (word == ",");
}

LcmStruct parse_struct(Lexer& lexer) {
  LcmStruct parsed{.name = name(lexer, "the name of a struct"), .members = {}};
  lexer.expect("{");
  for (std::string_view word = lexer.next(); word != "}"; word = lexer.next()) {
    if (word.empty() || !in_word(word.front())) lexer.refuse("a type", word);
    if (word == "const") {
      parse_constants(lexer, parsed);
    } else {
      parse_members(lexer, word, parsed);
    }
  }
  return parsed;
}

}  // namespace

std::vector<LcmStruct> parse_lcm(std::string_view source) {
  std::vector<LcmStruct> structs;
  Lexer lexer(source);
  for (std::string_view word = lexer.next(); !word.empty(); word = lexer.next()) {
    if (word == "package") {
      skip_to(lexer, ";");
    } else if (word == "struct") {
      structs.push_back(parse_struct(lexer));
    } else {
      lexer.refuse("`struct`", word);
    }
  }
  return structs;
}

}  // namespace gyrotwin
