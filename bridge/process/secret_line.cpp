#include "bridge/process/secret.hpp"

namespace fieldcast {

tl::expected<Secret, std::string> read_secret_line(const std::string& path, Readers readers) {
  const auto whole = read_secret_file(path, readers);
  if (!whole) return tl::unexpected(whole.error());
  std::string_view line = whole->text();
  line = line.substr(0, line.find('\n'));
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line.empty()) return tl::unexpected(path + ": its first line is empty");
  return Secret(line);
}

}  // namespace fieldcast
