#include "tools/cli/import/input_files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "bridge/base/errno_text.hpp"
#include "config/document/limits.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMebibyte = 1u << 20;

// Returns an empty text if the file may be read.
std::string fault_of(const std::string& path, std::size_t bytes_so_far) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (error) return error.message();
  if (fs::is_directory(status)) return "a folder; name the files in it";
  if (!fs::is_regular_file(status)) return "no regular file";
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return error.message();
  if (size > config::kMaxFileBytes)
    return fmt::format("{} MiB; lists of at most {} MiB are read: split it", size / kMebibyte,
                       config::kMaxFileBytes / kMebibyte);
  if (size + bytes_so_far > config::kMaxTotalBytes)
    return fmt::format("more than {} MiB with the files before it: import them in parts",
                       config::kMaxTotalBytes / kMebibyte);
  return {};
}

}  // namespace

tl::expected<std::vector<importing::InputFile>, std::string> read_inputs(
    const std::vector<std::string>& paths) {
  std::vector<importing::InputFile> inputs;
  std::size_t bytes = 0;
  for (const std::string& path : paths) {
    const auto fail = [&](const std::string& what) {
      return tl::unexpected(fmt::format("{}: {}", printable(path), what));
    };
    if (const std::string fault = fault_of(path, bytes); !fault.empty()) return fail(fault);
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file) return fail(errno == 0 ? "it does not open" : errno_text(errno));
    std::string text{std::istreambuf_iterator<char>(file), {}};
    if (file.bad()) return fail("it cannot be read");
    bytes += text.size();
    inputs.push_back({path, std::move(text)});
  }
  return inputs;
}

}  // namespace fieldcast::cli
