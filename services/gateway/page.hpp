// The files of the page, read once: what is not among them cannot be asked for.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace gyrotwin {

struct PageFile {
  std::string type;  ///< MIME
  std::string content;
  bool lasts = false;  ///< its name changes with its content
};

class Page {
 public:
  /// @param folder of the built page; a folder that is not there leaves a page that says how to
  ///        build one
  /// @throws Error when a file cannot be read
  explicit Page(const std::filesystem::path& folder);

  /// @param path of a URL, without query. @return null when there is no such file
  const PageFile* find(std::string_view path) const;

 private:
  std::map<std::string, PageFile, std::less<>> files_;
};

/// Where the page is: $GYROTWIN_PAGE, or found from the program's own place.
std::filesystem::path page_folder();

}  // namespace gyrotwin
