#include "services/gateway/access.hpp"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace gyrotwin {

namespace {

/// 32 hex digits.
std::string token_of(const Key& key, std::string_view purpose) {
  std::array<std::uint8_t, 16> bytes{};
  crypto_generichash(bytes.data(), bytes.size(),
                     reinterpret_cast<const std::uint8_t*>(purpose.data()), purpose.size(),
                     key.data(), key.size());
  std::array<char, 2 * bytes.size() + 1> hex{};
  sodium_bin2hex(hex.data(), hex.size(), bytes.data(), bytes.size());
  return hex.data();
}

/// Takes the same time wherever the two differ.
bool is_same(std::string_view given, std::string_view secret) {
  return given.size() == secret.size() &&
         sodium_memcmp(given.data(), secret.data(), secret.size()) == 0;
}

/// "lab:8765" of "lab:8765"; without the port. An IPv6 address keeps its brackets.
std::string_view name_of_host(std::string_view host) {
  const std::size_t end = host.starts_with('[') ? host.find(']') : std::string_view::npos;
  if (end != std::string_view::npos) return host.substr(0, end + 1);
  return host.substr(0, host.find(':'));
}

bool is_loopback_name(std::string_view name) {
  return name == "localhost" || name == "127.0.0.1" || name == "[::1]";
}

}  // namespace

std::string_view role_name(Role role) {
  if (role == Role::kOperator) return "operator";
  return role == Role::kObserver ? "observer" : "nobody";
}

Tokens make_tokens(const Key& key) {
  return {.observer = token_of(key, "gateway observer"),
          .operator_ = token_of(key, "gateway operator")};
}

Access::Access(Tokens tokens, std::vector<std::string> origins, bool any_program)
    : tokens_(std::move(tokens)), origins_(std::move(origins)), any_program_(any_program) {}

Access::Verdict Access::judge(const Caller& caller) const {
  const std::string_view name = name_of_host(caller.host);
  // A name that somebody else's DNS points here would make a foreign page look like ours.
  if (caller.from_loopback && !is_loopback_name(name)) {
    return {.reason = "ask for localhost or 127.0.0.1, not for another name of it"};
  }
  const std::string token = query_value(caller.target, "token");
  const bool is_operator = is_same(token, tokens_.operator_);
  if (!is_operator && !token.empty() && !is_same(token, tokens_.observer)) {
    return {.reason = "the token is wrong: `gyrotwin gateway --urls` prints the right ones"};
  }
  if (token.empty() && !caller.from_loopback) {
    return {.reason = "a token is needed from another host: `gyrotwin gateway --urls` prints them"};
  }
  if (caller.origin) {
    const std::string own = "http://" + std::string(caller.host);
    if (*caller.origin != own && std::ranges::find(origins_, *caller.origin) == origins_.end()) {
      return {.reason = "pages of " + std::string(*caller.origin) +
                        " may not connect: start the gateway with --allow-origin " +
                        std::string(*caller.origin)};
    }
  } else if (caller.wants_socket && !caller.from_loopback && !any_program_) {
    return {.reason =
                "programs on other hosts may not connect: start the gateway with "
                "--allow-programs"};
  }
  return {.role = is_operator ? Role::kOperator : Role::kObserver, .reason = {}};
}

std::string query_value(std::string_view target, std::string_view name) {
  const std::size_t begin = target.find('?');
  if (begin == std::string_view::npos) return {};
  std::string_view rest = target.substr(begin + 1);
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    if (equals == std::string_view::npos || pair.substr(0, equals) != name) continue;
    std::string value;
    for (std::size_t i = equals + 1; i < pair.size(); ++i) {
      std::uint8_t code = 0;
      if (pair[i] == '%' && i + 2 < pair.size() &&
          std::from_chars(pair.data() + i + 1, pair.data() + i + 3, code, 16).ptr ==
              pair.data() + i + 3) {
        value += static_cast<char>(code);
        i += 2;
      } else {
        value += pair[i];
      }
    }
    return value;
  }
  return {};
}

}  // namespace gyrotwin
