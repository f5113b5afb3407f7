// Dashboards and pictures in the store. Throws StoreError. One owner, the thread of the connection.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast::web {

// Without its content in a list.
struct StoredDocument {
  std::string name, title;
  std::int64_t version = 0;  // from 1
  std::string content;       // the text of a dashboard; of a picture SVG, or base64 of PNG
  std::string saved_by;
  UtcTime saved_at;
};

struct StoredPicture {
  StoredDocument document;  // without a title
  std::string type;         // "svg", "png"
  double width = 0, height = 0;
  std::int64_t bytes = 0;
};

class DashboardTable {
 public:
  static constexpr std::size_t kMaxDashboards = 200;
  static constexpr std::int64_t kKeptVersions = 20;  // of each dashboard

  explicit DashboardTable(SqlConnection& connection) : connection_(connection) {}

  [[nodiscard]] std::vector<StoredDocument> list();  // the newest versions, sorted by name
  // Without a version, the newest one.
  [[nodiscard]] std::optional<StoredDocument> find(const std::string& name,
                                                   std::optional<std::int64_t> version);
  // Stores document.version as the successor of version - 1, and returns false if the newest
  // version is not version - 1, or if the name is new and there are kMaxDashboards.
  [[nodiscard]] bool save(const StoredDocument& document);
  // Removes all versions. Returns false if the newest version is not `version`.
  [[nodiscard]] bool remove(const std::string& name, std::int64_t version);

 private:
  SqlConnection& connection_;
};

class PictureTable {
 public:
  static constexpr std::size_t kMaxPictures = 200;

  explicit PictureTable(SqlConnection& connection) : connection_(connection) {}

  [[nodiscard]] std::vector<StoredPicture> list();  // sorted by name
  [[nodiscard]] std::optional<StoredPicture> find(const std::string& name);
  // Replaces a picture of this name and counts its version up. Returns the version; 0 if the name
  // is new and there are kMaxPictures.
  [[nodiscard]] std::int64_t save(const StoredPicture& picture);
  [[nodiscard]] bool remove(const std::string& name);  // false: there is none

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast::web
