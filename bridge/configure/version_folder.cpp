#include "bridge/configure/version_folder.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bridge/security/file_access.hpp"
#include "core/base/json.hpp"

namespace fieldcast::configure {

namespace {

namespace fs = std::filesystem;
using Tree = nlohmann::json;

constexpr std::string_view kList = "versions.json", kWatch = "watch.json";
// Of a file: a watch names each good channel, up to 100 000 with 200 bytes each.
constexpr std::size_t kLongestFile = 32u << 20;

bool exists(const std::string& path) {
  std::error_code failure;
  return fs::exists(path, failure);
}

// Invalid or missing content is an empty value: versions must not prevent a change.
Tree tree_of(const std::string& path) {
  if (!exists(path)) return {};
  return Tree::parse(security::read_file(path, kLongestFile), nullptr, false);
}

template <class T>
T value_in(const Tree& object, const char* name, T missing) {
  try {
    return object.value(name, missing);
  } catch (const Tree::exception&) { return missing; }
}

}  // namespace

std::string version_of(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
  unsigned length = 0;
  EVP_Digest(text.data(), text.size(), hash.data(), &length, EVP_sha256(), nullptr);
  std::string hex;
  for (std::size_t i = 0; i < 8; ++i) hex += fmt::format("{:02x}", hash[i]);
  return hex;
}

VersionFolder::VersionFolder(const std::string& file) : file_(file) {
  std::error_code failure;
  const fs::path whole = fs::canonical(file, failure);
  if (!failure) file_ = whole.string();
  folder_ = file_ + ".versions";
  const Tree list = tree_of(path(kList));
  if (!list.is_array()) return;
  for (const Tree& row : list) {
    if (!row.is_object()) continue;
    rows_.push_back({value_in<std::string>(row, "version", ""),
                     value_in<std::string>(row, "who", ""), value_in<std::string>(row, "why", ""),
                     UtcTime{value_in<std::int64_t>(row, "at", 0)},
                     value_in<std::string>(row, "state", "")});
  }
}

std::string VersionFolder::path(std::string_view name) const {
  return folder_ + '/' + std::string(name);
}

std::string VersionFolder::present() const { return security::read_file(file_, kLongestFile); }

// A version is a file name, and may come from a client.
std::optional<std::string> VersionFolder::text_of(const std::string& version) const {
  if (!std::ranges::any_of(rows_, [&](const VersionRow& row) { return row.version == version; }) ||
      version.find('/') != std::string::npos)
    return std::nullopt;
  const std::string name = path(version + ".yaml");
  return exists(name) ? std::optional(security::read_file(name, kLongestFile)) : std::nullopt;
}

void VersionFolder::make_folder() {
  if (!exists(folder_)) security::make_folder(folder_);
}

void VersionFolder::add(VersionRow row, const std::string& text) {
  make_folder();
  security::replace(path(row.version + ".yaml"), text, security::kOwnerOnly);
  const auto is_in_force = [in_force = version_of(present())](const VersionRow& other) {
    return other.version == in_force;
  };
  std::vector<VersionRow> rows = rows_;
  rows.push_back(std::move(row));
  std::vector<std::string> old;
  while (rows.size() > kMostVersions) {
    // The text in force stays: the roll-back of this deployment needs it.
    auto oldest = rows.begin();
    if (is_in_force(*oldest) && std::ranges::count_if(rows, is_in_force) == 1) ++oldest;
    old.push_back(oldest->version);
    rows.erase(oldest);
  }
  write_list(rows);
  rows_ = std::move(rows);
  is_unwritten_ = false;
  for (const std::string& version : old) {
    const auto same = [&](const VersionRow& other) { return other.version == version; };
    if (std::ranges::none_of(rows_, same)) ::unlink(path(version + ".yaml").c_str());
  }
}

void VersionFolder::set_state(const std::string& version, std::string state) {
  const auto row = std::find_if(rows_.rbegin(), rows_.rend(),
                                [&](const VersionRow& other) { return other.version == version; });
  if (row == rows_.rend()) return;
  row->state = std::move(state);
  is_unwritten_ = true;
  write();
}

void VersionFolder::write() {
  write_list(rows_);
  is_unwritten_ = false;
}

void VersionFolder::write_list(const std::vector<VersionRow>& rows) const {
  // A user may change the file in place, and the version must keep its text.
  for (const VersionRow& row : rows) {
    if (is_shared(row.version))
      security::replace(path(row.version + ".yaml"), present(), security::kOwnerOnly);
  }
  Json list = Json::array();
  for (const VersionRow& row : rows)
    list.push_back({{"version", row.version},
                    {"who", row.who},
                    {"why", row.why},
                    {"at", row.at.nanoseconds},
                    {"state", row.state}});
  security::replace(path(kList), list.text(), security::kOwnerOnly);
}

void VersionFolder::replace(const std::string& text) { security::replace(file_, text, mode()); }

void VersionFolder::restore(const std::string& version) {
  const auto text = text_of(version);
  if (!text) throw security::SecurityError("the version " + version + " is not kept any more");
  try {
    replace(*text);
  } catch (const security::FileError& error) {
    if (!error.is_full()) throw;
    security::replace_by_link(file_, path(version + ".yaml"), mode());
  }
}

mode_t VersionFolder::mode() const {
  struct stat found {};
  return ::stat(file_.c_str(), &found) == 0 ? (found.st_mode & 0777) : security::kOwnerOnly;
}

bool VersionFolder::is_shared(const std::string& version) const {
  std::error_code failure;
  return fs::equivalent(file_, path(version + ".yaml"), failure);
}

std::optional<Watch> VersionFolder::stored_watch() const {
  const Tree stored = tree_of(path(kWatch));
  if (!stored.is_object()) return std::nullopt;
  Watch watch;
  watch.version = value_in<std::string>(stored, "version", "");
  watch.base = value_in<std::string>(stored, "base", "");
  watch.who = value_in<std::string>(stored, "who", "");
  watch.restarts = value_in(stored, "restarts", 0);
  watch.good = value_in<std::vector<std::string>>(stored, "good", {});
  return watch;
}

void VersionFolder::store_watch(const std::optional<Watch>& watch) {
  if (!watch) {
    ::unlink(path(kWatch).c_str());
    return;
  }
  make_folder();
  const Json stored{{"version", watch->version},
                    {"base", watch->base},
                    {"who", watch->who},
                    {"restarts", watch->restarts},
                    {"good", watch->good}};
  security::replace(path(kWatch), stored.text(), security::kOwnerOnly);
}

}  // namespace fieldcast::configure
