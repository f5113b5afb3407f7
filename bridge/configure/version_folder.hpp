// Versions of a configuration file, in a folder beside it, and its replacement. A power loss leaves
// the old or the new file, complete. Throws security::SecurityError with the path. One thread at a
// time.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/configure/watch.hpp"
#include "core/base/time.hpp"

namespace fieldcast::configure {

// 16 hexadecimal digits of the SHA-256 of the text.
[[nodiscard]] std::string version_of(std::string_view text);

// A text that was in force.
struct VersionRow {
  std::string version, who, why;
  UtcTime at;
  std::string state;  // "watching", "kept", "confirmed", "rolled back: REASON", "found"
};

class VersionFolder {
 public:
  static constexpr std::size_t kMostVersions = 100;  // then the oldest not in force are deleted

  // `file`: the configuration; a link is followed.
  explicit VersionFolder(const std::string& file);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::string present() const;                                   // text of the file
  [[nodiscard]] const std::vector<VersionRow>& rows() const { return rows_; }  // oldest first
  // Empty if the version is unknown.
  [[nodiscard]] std::optional<std::string> text_of(const std::string& version) const;

  // Adds a row and keeps its text. The same text may have several rows.
  void add(VersionRow row, const std::string& text);
  // Sets the state of the last row of this version. On failure the row has the state, but not the
  // list on the disk: is_unwritten().
  void set_state(const std::string& version, std::string state);
  // True if the list on the disk is older than rows(); write() then tries again. The next add() and
  // set_state() write it too.
  [[nodiscard]] bool is_unwritten() const { return is_unwritten_; }
  void write();
  // Replaces the configuration file; its access rights remain.
  void replace(const std::string& text);
  // Replaces the configuration file by a version that is kept, also on a full disk.
  void restore(const std::string& version);

  // The watch of a process that ended within it.
  [[nodiscard]] std::optional<Watch> stored_watch() const;
  void store_watch(const std::optional<Watch>& watch);  // empty: deletes it

 private:
  [[nodiscard]] std::string path(std::string_view name) const;
  void write_list(const std::vector<VersionRow>& rows) const;
  [[nodiscard]] mode_t mode() const;  // access rights of the configuration file
  // True if the file and its version are one file, after a restore() on a full disk.
  [[nodiscard]] bool is_shared(const std::string& version) const;
  void make_folder();

  std::string file_, folder_;
  std::vector<VersionRow> rows_;
  bool is_unwritten_ = false;
};

}  // namespace fieldcast::configure
