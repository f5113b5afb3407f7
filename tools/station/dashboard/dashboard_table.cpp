#include "tools/station/dashboard/dashboard_table.hpp"

namespace fieldcast::web {

namespace {

StoredDocument document_of(const SqlRow& row) {
  return {.name = text_at(row, 0),
          .title = text_at(row, 1),
          .version = integer_at(row, 2),
          .content = text_at(row, 3),
          .saved_by = text_at(row, 4),
          .saved_at = UtcTime{integer_at(row, 5)}};
}

StoredPicture picture_of(const SqlRow& row) {
  return {.document = document_of(row),
          .type = text_at(row, 6),
          .width = static_cast<double>(integer_at(row, 7)),
          .height = static_cast<double>(integer_at(row, 8)),
          .bytes = integer_at(row, 9)};
}

}  // namespace

std::vector<StoredDocument> DashboardTable::list() {
  std::vector<StoredDocument> found;
  connection_.query(
      "select name, title, version, '', saved_by, saved_at from dashboards d where version = "
      "(select max(version) from dashboards where name = d.name) order by name",
      {}, [&](const SqlRow& row) {
        found.push_back(document_of(row));
        return true;
      });
  return found;
}

std::optional<StoredDocument> DashboardTable::find(const std::string& name,
                                                   std::optional<std::int64_t> version) {
  std::optional<StoredDocument> found;
  connection_.query(
      "select name, title, version, content, saved_by, saved_at from dashboards where name = $1 "
      "and version = case when cast($2 as bigint) > 0 then cast($2 as bigint) else (select "
      "max(version) from dashboards where name = $1) end",
      {name, version.value_or(0)}, [&](const SqlRow& row) {
        found = document_of(row);
        return false;
      });
  return found;
}

bool DashboardTable::save(const StoredDocument& document) {
  SqlTransaction transaction(connection_);
  const std::uint64_t saved = connection_.execute(
      "insert into dashboards (name, title, version, content, saved_by, saved_at) select "
      "cast($1 as text), cast($2 as text), cast($3 as bigint), cast($4 as text), cast($5 as text), "
      "cast($6 as bigint) where coalesce((select max(version) from dashboards where name = $1), 0) "
      "= cast($3 as bigint) - 1 and (cast($3 as bigint) > 1 or (select count(distinct name) from "
      "dashboards) < $7) on conflict do nothing",
      SqlRow{document.name, document.title, document.version, document.content, document.saved_by,
             document.saved_at.nanoseconds, static_cast<std::int64_t>(kMaxDashboards)});
  if (saved == 0) return false;
  connection_.execute("delete from dashboards where name = $1 and version <= $2",
                      SqlRow{document.name, document.version - kKeptVersions});
  transaction.commit();
  return true;
}

bool DashboardTable::remove(const std::string& name, std::int64_t version) {
  return connection_.execute(
             "delete from dashboards where name = $1 and (select max(version) from dashboards "
             "where name = $1) = $2",
             SqlRow{name, version}) > 0;
}

std::vector<StoredPicture> PictureTable::list() {
  std::vector<StoredPicture> found;
  connection_.query(
      "select name, '', version, '', saved_by, saved_at, type, width, height, bytes from pictures "
      "order by name",
      {}, [&](const SqlRow& row) {
        found.push_back(picture_of(row));
        return true;
      });
  return found;
}

std::optional<StoredPicture> PictureTable::find(const std::string& name) {
  std::optional<StoredPicture> found;
  connection_.query(
      "select name, '', version, content, saved_by, saved_at, type, width, height, bytes from "
      "pictures where name = $1",
      {name}, [&](const SqlRow& row) {
        found = picture_of(row);
        return false;
      });
  return found;
}

std::int64_t PictureTable::save(const StoredPicture& picture) {
  const StoredDocument& document = picture.document;
  std::int64_t version = 0;
  connection_.query(
      "insert into pictures (name, version, content, saved_by, saved_at, type, width, height, "
      "bytes) select cast($1 as text), 1, cast($2 as text), cast($3 as text), cast($4 as bigint), "
      "cast($5 as text), cast($6 as bigint), cast($7 as bigint), cast($8 as bigint) where "
      "exists (select 1 from pictures where name = $1) or (select count(*) from pictures) < $9 "
      "on conflict (name) do update set version = pictures.version + 1, content = "
      "excluded.content, saved_by = excluded.saved_by, saved_at = excluded.saved_at, type = "
      "excluded.type, width = excluded.width, height = excluded.height, bytes = excluded.bytes "
      "returning version",
      {document.name, document.content, document.saved_by, document.saved_at.nanoseconds,
       picture.type, static_cast<std::int64_t>(picture.width),
       static_cast<std::int64_t>(picture.height), picture.bytes,
       static_cast<std::int64_t>(kMaxPictures)},
      [&](const SqlRow& row) {
        version = integer_at(row, 0);
        return true;
      });
  return version;
}

bool PictureTable::remove(const std::string& name) {
  return connection_.execute("delete from pictures where name = $1", SqlRow{name}) == 1;
}

}  // namespace fieldcast::web
