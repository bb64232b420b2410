// Who may look, and who may act. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/runtime/key.hpp"

namespace gyrotwin {

enum class Role : std::uint8_t { kNobody, kObserver, kOperator };

/// "observer", "operator".
std::string_view role_name(Role role);

/// Secrets in a URL's query: `?token=...`.
struct Tokens {
  std::string observer, operator_;
};

/// Both follow from a key, so that they last as long as it and every gateway that has it has the
/// same.
Tokens make_tokens(const Key& key);

/// What a request over HTTP says of who asks.
struct Caller {
  bool from_loopback = false;
  std::string_view host;                   ///< header Host
  std::optional<std::string_view> origin;  ///< header Origin: the page a browser shows
  std::string_view target;                 ///< path and query
  bool wants_socket = false;               ///< a WebSocket, not a document
};

/// The rules: README.md, who may do what.
class Access {
 public:
  /// @param origins of foreign pages that may connect, `https://app.foxglove.dev`
  /// @param any_program whether who is no browser's page may connect from another host
  Access(Tokens tokens, std::vector<std::string> origins, bool any_program);

  struct Verdict {
    Role role = Role::kNobody;
    std::string reason;  ///< why nobody, and the fix
  };
  Verdict judge(const Caller& caller) const;

 private:
  Tokens tokens_;
  std::vector<std::string> origins_;
  bool any_program_;
};

/// The value of a name in a target's query, percent signs undone; empty without it.
std::string query_value(std::string_view target, std::string_view name);

}  // namespace gyrotwin
