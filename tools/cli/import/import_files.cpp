#include "tools/cli/import/import_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/security/file_access.hpp"
#include "bridge/security/pki.hpp"
#include "config/document/limits.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

namespace {

using importing::Fate;
using importing::PointFate;

std::string one_line(std::string_view text) {
  std::string line = printable(text);
  for (char& c : line) {
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  }
  return line;
}

Cell fate_cell(const PointFate& row) {
  switch (row.fate) {
    case Fate::kMoved: return {"moved", Tone::kGood};
    case Fate::kChanged: return {"moved, but: " + one_line(row.words), Tone::kWarning};
    case Fate::kRefused: return {"not moved: " + one_line(row.words), Tone::kBad};
  }
  return {};
}

}  // namespace

std::vector<std::string> import_lines(const importing::Outcome& outcome, bool all,
                                      const Screen& screen) {
  TextTable table({{"WHERE"}, {"NAME"}, {"CHANNEL"}, {"AT"}, {"TYPE"}, {"WITH"}, {"MOVED?"}});
  const bool files = outcome.recognised.size() > 1;
  std::size_t moved = 0;
  for (const PointFate& row : outcome.rows) {
    if (row.fate == Fate::kMoved && ++moved > kMovedShown && !all) continue;
    std::string where = files ? fmt::format("{}:{}", one_line(row.origin.file), row.origin.line)
                              : fmt::format("line {}", row.origin.line);
    if (row.origin.column > 0) where += fmt::format(":{}", row.origin.column);
    table.add_row({{where, Tone::kFaint},
                   {clip(one_line(row.name), 40)},
                   {row.channel},
                   {row.at},
                   {row.type},
                   {importing::settings_of(row)},
                   fate_cell(row)});
  }
  std::vector<std::string> lines =
      table.rows() == 0 ? std::vector<std::string>{} : table.render(screen);
  if (moved > kMovedShown && !all)
    lines.push_back(
        fmt::format("{} more moved as they are; --all shows them", moved - kMovedShown));
  return lines;
}

std::string import_summary(const importing::Outcome& outcome) {
  return fmt::format("{} moved, {} moved with a change, {} cannot be moved",
                     outcome.count(Fate::kMoved), outcome.count(Fate::kChanged),
                     outcome.count(Fate::kRefused));
}

Json fate_json(const PointFate& row) {
  constexpr const char* kFates[] = {"moved", "changed", "refused"};
  Json json = {{"fate", kFates[static_cast<std::size_t>(row.fate)]},
               {"name", row.name},
               {"channel", row.channel},
               {"at", row.at},
               {"type", row.type},
               {"why", row.words},
               {"file", row.origin.file},
               {"line", row.origin.line}};
  if (row.origin.column > 0) json.add("column", row.origin.column);
  if (row.fate == Fate::kRefused) return json;
  const auto order = [](bool little) { return little ? "little-endian" : "big-endian"; };
  json.add("scale", row.scale);
  json.add("offset", row.offset);
  json.add("word_order", order(row.word_order == WordOrder::kLittleEndian));
  json.add("byte_order", order(row.byte_order == ByteOrder::kLittleEndian));
  json.add("access", to_text(row.access));
  return json;
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMebibyte = 1u << 20;

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

namespace {

// Not NAME.new, which may be a file of the user.
std::string beside(const std::string& path) { return fmt::format("{}.{}.new", path, ::getpid()); }

// Returns 0 or an errno. Replaces atomically, only with `replace`.
int give_name(const std::string& path, bool replace) {
  const unsigned flags = replace ? 0 : RENAME_NOREPLACE;
  if (::renameat2(AT_FDCWD, beside(path).c_str(), AT_FDCWD, path.c_str(), flags) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // For file systems without RENAME_NOREPLACE: link() fails if the file exists.
  if (!replace && ::link(beside(path).c_str(), path.c_str()) != 0) return errno;
  if (!replace) return ::unlink(beside(path).c_str()) == 0 ? 0 : errno;
  return std::rename(beside(path).c_str(), path.c_str()) == 0 ? 0 : errno;
}

}  // namespace

std::optional<std::string> write_new_files(const std::vector<NewFile>& files, bool replace) {
  const auto refused = [](const std::string& path) {
    return fmt::format("{} is there already; it is not written over (--force does)",
                       printable(path));
  };
  std::error_code ignored;
  for (const NewFile& file : files) {
    if (!replace && std::filesystem::exists(file.path, ignored)) return refused(file.path);
  }
  std::optional<std::string> fault;
  try {
    for (const NewFile& file : files) {
      security::write_new(beside(file.path), file.text, security::kForAll);
    }
  } catch (const security::SecurityError& error) { fault = error.what(); }
  std::size_t named = 0;
  for (; !fault && named < files.size(); ++named) {
    const int error = give_name(files[named].path, replace);
    if (error == 0) continue;
    fault = error == EEXIST ? refused(files[named].path)
                            : fmt::format("cannot write {}: {}", printable(files[named].path),
                                          errno_text(error));
    break;
  }
  if (!fault) return std::nullopt;
  for (std::size_t i = 0; i < files.size(); ++i) {
    ::unlink(beside(files[i].path).c_str());
    if (i < named && !replace) ::unlink(files[i].path.c_str());
  }
  return fault;
}

}  // namespace fieldcast::cli
