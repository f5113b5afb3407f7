#include "config/files/library.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "config/document/limits.hpp"
#include "config/document/suggest.hpp"
#include "config/files/file_reader.hpp"
#include "core/model/channel_kind.hpp"

namespace fieldcast::config {
namespace {

constexpr std::string_view kChannelList = "channel list", kTemplate = "template",
                           kProtocol = "protocol";

// Empty if the text may be of this kind; otherwise it is not parsed.
std::string_view fault_of_kind(std::string_view text, std::string_view what) {
  if (is_empty(text)) return {};
  if (what == kChannelList) return has_columns(text) ? "" : kNoChannelList;
  if (what == kTemplate) return is_template(text) ? "" : kNoTemplate;
  return is_declaration(text) ? "" : kNoDeclaration;
}

// Template names are words, not paths: a bridge only reads from its directories.
bool is_word(std::string_view name) {
  return !name.empty() && name.size() <= kMaxNameLength && name != "." && name != ".." &&
         name.find_first_not_of(
             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_.") ==
             std::string_view::npos;
}

std::string with_slash(std::string directory) {
  if (!directory.empty() && !directory.ends_with('/')) directory += '/';
  return directory;
}

std::vector<std::string> folders(const Node& naming, std::string_view own,
                                 std::span<const std::string> others) {
  std::vector<std::string> directories{resolve(*naming.position.source, own)};
  for (const auto& directory : others) directories.push_back(with_slash(directory));
  return directories;
}

}  // namespace

Library::Library(const FileReader& reader, const LoadOptions& options, FaultList& faults,
                 std::size_t used)
    : reader_(reader), options_(options), faults_(faults), used_(used) {}

tl::expected<std::string, FileError> Library::read(const std::string& path) {
  if (!reader_.read) return tl::unexpected(FileError::kMissing);
  auto text = reader_.read(path);
  if (!text) return text;
  used_ += text->size();
  if (text->size() > kMaxFileBytes || used_ > kMaxTotalBytes)
    return tl::unexpected(FileError::kTooLarge);
  return text;
}

const Node* Library::opened(const std::string& path, const Node& naming, std::string_view what) {
  if (const auto known = documents_.find(path); known != documents_.end())
    return known->second->root;
  auto text = read(path);
  if (!text) {
    const std::string directories[] = {std::string(directory_of(path))};
    fault_missing(naming, fmt::format("{} '{}' ", what, naming.text), text.error(), directories,
                  "");
    return nullptr;
  }
  return keep(path, std::move(*text), what);
}

const Node* Library::keep(const std::string& path, std::string text, std::string_view what) {
  const bool csv = what == kChannelList;
  Source source{path, std::move(text), documents_.size() + 1};
  const auto faults_before = faults_.size();
  if (const std::string_view wrong_kind = fault_of_kind(source.text, what); !wrong_kind.empty()) {
    auto unread = std::make_unique<Document>();
    unread->source = {path, {}, source.order};
    faults_.add({&unread->source, 0, 0}, wrong_kind);
    return documents_.emplace(path, std::move(unread)).first->second->root;
  }
  auto document =
      csv ? parse_csv(std::move(source), faults_) : parse_yaml(std::move(source), faults_);
  if (document->root == nullptr && faults_.size() == faults_before)
    faults_.add({&document->source, 0, 0}, "the file is empty");
  return documents_.emplace(path, std::move(document)).first->second->root;
}

const Node* Library::channel_list(const Node& naming) {
  return opened(resolve(*naming.position.source, naming.text), naming, kChannelList);
}

const Node* Library::device_template(const Node& naming) {
  if (naming.kind != Kind::kScalar || !is_word(naming.text)) {
    faults_.add(naming.position,
                naming.kind == Kind::kScalar ? fmt::format("template '{}' is no name", naming.text)
                                             : fmt::format("template is {}", to_text(naming.kind)),
                "the name of a file in devices/, without .yaml");
    return nullptr;
  }
  const auto directories = folders(naming, "devices/", options_.template_directories);
  const Found found = in_directories(naming, kTemplate, directories);
  if (!found.exists)
    fault_missing(naming, fmt::format("template '{}' ", naming.text), FileError::kMissing,
                  directories, ".yaml");
  return found.root;
}

Library::Found Library::protocol_declaration(const Node& naming) {
  if (!is_word(naming.text)) return {};
  return in_directories(naming, kProtocol,
                        folders(naming, "protocols/", options_.protocol_directories));
}

std::vector<std::string> Library::declared_protocols(const Node& naming) const {
  return names_in(folders(naming, "protocols/", options_.protocol_directories), ".yaml");
}

Library::Found Library::in_directories(const Node& naming, std::string_view what,
                                       std::span<const std::string> directories) {
  for (const auto& directory : directories) {
    const std::string path = fmt::format("{}{}.yaml", directory, naming.text);
    if (documents_.contains(path)) return {true, opened(path, naming, what)};
    auto text = read(path);
    if (text) return {true, keep(path, std::move(*text), what)};
    if (text.error() == FileError::kMissing) continue;
    fault_missing(naming, fmt::format("{} '{}' ", what, naming.text), text.error(), directories,
                  ".yaml");
    return {true, nullptr};
  }
  return {};
}

std::string Library::check_file(const Node& naming) {
  const std::string path = resolve(*naming.position.source, naming.text);
  if (const auto text = read(path); !text)
    faults_.add(naming.position, fmt::format("file '{}' {}", naming.text, to_text(text.error())));
  return path;
}

std::vector<std::string> Library::names_in(std::span<const std::string> directories,
                                           std::string_view suffix) const {
  std::vector<std::string> names;
  if (!reader_.list) return names;
  for (const auto& directory : directories) {
    for (auto& name : reader_.list(directory)) {
      if (!name.ends_with(suffix)) continue;
      name.resize(name.size() - suffix.size());
      names.push_back(std::move(name));
    }
  }
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

void Library::fault_missing(const Node& naming, const std::string& what, FileError error,
                            std::span<const std::string> directories, std::string_view suffix) {
  const auto names = names_in(directories, suffix);
  const std::vector<std::string_view> candidates(names.begin(), names.end());
  const auto folder = directory_of(naming.text);
  // An existing file that cannot be read would be suggested itself.
  const auto meant = error == FileError::kMissing
                         ? closest(std::string_view(naming.text).substr(folder.size()), candidates)
                         : std::string();
  std::string allowed;
  if (error == FileError::kUnreadable)
    allowed = "a regular file that the user of this program may read";
  else if (error == FileError::kMissing && meant.empty())
    allowed = suffix.empty() ? "the path of a file, relative to the file that names it"
                             : fmt::format("the name of a file in {}, without {}",
                                           fmt::join(directories, " or "), suffix);
  faults_.add(naming.position, what + std::string(to_text(error)), allowed,
              meant.empty() ? meant : std::string(folder) + meant);
}

}  // namespace fieldcast::config
