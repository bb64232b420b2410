#include "services/gateway/page.hpp"

#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kTypes{{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".json", "application/json"},
    {".webmanifest", "application/manifest+json"},
    {".woff2", "font/woff2"},
    {".txt", "text/plain; charset=utf-8"},
}};

constexpr std::string_view kMissing =
    "<!doctype html><meta charset=utf-8><title>gyrotwin</title>"
    "<p>The gateway runs; its page is not built. <code>deploy/run</code> builds it, or "
    "<code>npm ci && npm run build</code> in <code>clients/dashboard</code>.";

std::string type_of(const fs::path& file) {
  for (const auto& [end, type] : kTypes) {
    if (file.extension() == end) return std::string(type);
  }
  return "application/octet-stream";
}

}  // namespace

Page::Page(const fs::path& folder) {
  files_["/"] = {type_of("index.html"), std::string(kMissing)};
  if (!fs::is_regular_file(folder / "index.html")) return;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    if (!file) throw Error(entry.path().string() + ": cannot be read");
    const std::string name = '/' + entry.path().lexically_relative(folder).generic_string();
    files_[name] = {type_of(entry.path()), std::string(std::istreambuf_iterator<char>(file), {}),
                    name.starts_with("/assets/")};
  }
  files_["/"] = files_.at("/index.html");
}

const PageFile* Page::find(std::string_view path) const {
  const auto found = files_.find(path);
  return found == files_.end() ? nullptr : &found->second;
}

fs::path page_folder() {
  if (const char* folder = std::getenv("GYROTWIN_PAGE")) return folder;
  std::error_code none;
  const fs::path bin = fs::read_symlink("/proc/self/exe", none).parent_path();
  const fs::path installed = bin.parent_path() / "share/gyrotwin/page";
  return fs::exists(installed) ? installed : fs::path(GYROTWIN_BUILT_PAGE);
}

}  // namespace gyrotwin
