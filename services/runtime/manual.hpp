// Man page and completion of a program, from its own description of its command line.
#pragma once

#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace gyrotwin {

/// "gyrotwin ctl" of gyrotwin-ctl.
std::string as_typed(const CLI::App& app);

/// What CommandLine::run() (cli.hpp) prints for --print-manual: the man page, in troff's man
/// macros: name, synopsis, description, every option, every subcommand with its options, and the
/// app's footer, of which what begins with "Example" becomes the examples.
std::string manual(const CLI::App& app, std::string_view version);

/// And for --print-words: what may be typed, one context a line, "gyrotwin-ctl wait<TAB>--timeout=S
/// --json MODE: ...": subcommands as they are, options with `=` and the type of their value where
/// they take one, arguments by the type of theirs with `:` behind.
std::string completion_words(const CLI::App& app);

}  // namespace gyrotwin
