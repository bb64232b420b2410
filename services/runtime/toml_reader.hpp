// Reads a TOML document of [table]s with plain keys, and collects every mistake with its place and
// its fix. Knows nothing of rigs.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gyrotwin {

/// Numbers that a key takes; always finite ones.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;  ///< `low` itself is out

  bool contains(double x) const noexcept;
  /// As words after "a number": "", " > 0", " from 0 to 255".
  std::string text() const;
};

inline constexpr Range kAnyNumber{};
inline constexpr Range kPositive{.low = 0.0, .above_low = true};
inline constexpr Range kNotNegative{.low = 0.0};

/// Texts that a key takes.
struct TextRule {
  std::string_view takes;  ///< in words: "a text of capital letters"
  bool (*holds)(const std::string& text);
};

/// One word of an enumeration, as it stands in a file.
template <class Enum>
struct Word {
  std::string_view name;
  Enum value;
};

/// Whether the keys of a table must be there; an optional key keeps the value that it has.
enum class Need { kRequired, kOptional };

class TomlReader {
 public:
  /// What is known of one key, once it was asked for.
  struct Key {
    std::string table;
    std::string name;
    std::string takes;  ///< type and range in words
    Need need;
    std::string value;  ///< in effect, as TOML; empty: none
    std::string path() const { return table + '.' + name; }
  };

  /// In the document, both from 1.
  struct Place {
    unsigned line = 1, column = 1;
  };

  class Table;

  /// @param source stands before line and column in messages
  /// @param overrides `table.key=value` texts, later ones win; what is no TOML value but one word
  /// is
  ///        a text
  /// @throws Error with the place, when the document is not TOML
  TomlReader(std::string_view document, std::string source,
             const std::vector<std::string>& overrides);
  ~TomlReader();

  /// Whether the document has it, or an override gives a key of it.
  bool has_table(const std::string& name) const;
  /// A table to read from; it and the keys that are read from it count as known.
  Table table(std::string name, Need need);

  /// Notes that the values of these keys (`table.key`) do not go together; placed at the first that
  /// was overridden, or else at the first.
  void mistake(std::initializer_list<std::string> paths, const std::string& text);

  /// A key that may be left out (`table.key`) is needed after all; missing, it is told with `why`.
  void need(const std::string& path, std::string why);

  /// After everything was read: looks for unknown and missing keys too.
  /// @throws Error with all mistakes, each on a line of its own, if there are any
  void finish();

  /// All keys that were read, in that order.
  const std::vector<Key>& keys() const { return keys_; }
  /// What is in effect, defaults and overrides included, as TOML in the order of reading.
  std::string effective() const;

 private:
  struct Document;  // keeps toml++ out of this header
  struct Mistake {
    Place place;
    std::string text;
  };

  void apply(const std::string& override_text);
  void note(const std::string& path, Place place, const std::string& text);
  void report_unknown();
  void report_unknown_table(const std::string& name, Place place);
  void report_missing();
  /// The known key that `path` is most likely meant to be; null when none is near.
  const Key* nearest_key(const std::string& path) const;

  std::string source_;
  std::unique_ptr<Document> document_;
  std::vector<std::string> tables_;
  std::vector<Key> keys_;
  std::map<std::string, std::string> missing_;  // paths of required keys, and why if it is special
  std::vector<Mistake> mistakes_;
};

/// One [table] of a document. Each function reads a key; @return whether the value is sound. A
/// value that is not stays as it was, except numbers.
class TomlReader::Table {
 public:
  /// A number that is wrong or missing is NaN afterwards: comparisons with it come out false.
  bool number(const char* key, double& value, Range range);
  bool number(const char* key, std::optional<double>& value, Range range);
  bool integer(const char* key, int& value, Range range);
  bool flag(const char* key, bool& value);
  bool text(const char* key, std::string& value, const TextRule& rule);
  bool numbers(const char* key, std::vector<double>& value);

  template <class Enum, std::size_t N>
  bool word(const char* key, Enum& value, const std::array<Word<Enum>, N>& words) {
    std::array<std::string_view, N> names;
    std::size_t index = N;
    for (std::size_t i = 0; i < N; ++i) {
      names[i] = words[i].name;
      if (words[i].value == value) index = i;
    }
    const bool right = one_of(key, index, names);
    if (right) value = words[index].value;
    return right;
  }

 private:
  friend class TomlReader;
  Table(TomlReader& reader, std::string name, Need need)
      : reader_(reader), name_(std::move(name)), need_(need) {}

  bool one_of(const char* key, std::size_t& index, std::span<const std::string_view> names);
  /// Notes the key. @return whether the document has it
  bool find(const char* key, std::string takes);
  /// Notes that the key's value is not what it takes. @return false
  bool wrong(const char* key, const std::string& hint = {});
  void in_effect(std::string value) { reader_.keys_.back().value = std::move(value); }

  TomlReader& reader_;
  std::string name_;
  Need need_;
};

}  // namespace gyrotwin
