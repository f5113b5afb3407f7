// Runs every query in docs/store.md and compares its tables with the columns of the views.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "bridge/store/sql/sql.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"

namespace fieldcast {
namespace {

std::vector<std::string> lines_of_the_document() {
  std::ifstream file(std::string(FIELDCAST_SOURCE) + "/docs/store.md");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

// Returns the ```sql blocks marked <!-- database: both --> and those of this database.
std::vector<std::string> blocks_for(const std::string& database) {
  std::vector<std::string> blocks;
  std::string marker;
  bool inside = false;
  for (const std::string& line : lines_of_the_document()) {
    if (line.starts_with("```")) {
      inside = line == "```sql" && (marker == "both" || marker == database);
      if (inside) blocks.emplace_back();
    } else if (inside) {
      blocks.back() += line + '\n';
    }
    std::smatch found;
    marker = std::regex_match(line, found, std::regex("<!-- database: (\\w+) -->")) ? found[1].str()
                                                                                    : "";
  }
  return blocks;
}

std::set<std::string> quoted_names(const std::string& text) {
  static const std::regex name("`([a-z_]+)`");
  std::set<std::string> names;
  for (std::sregex_iterator at(text.begin(), text.end(), name), end; at != end; ++at)
    names.insert((*at)[1]);
  return names;
}

struct Section {
  std::set<std::string> views, columns;
};
std::vector<Section> sections() {
  std::vector<Section> found;
  bool in_table = false;
  for (const std::string& line : lines_of_the_document()) {
    if (line.starts_with("## ")) {
      found.push_back({quoted_names(line), {}});
    } else if (line == "| column | what it is |") {
      in_table = true;
    } else if (!line.starts_with("|")) {
      in_table = false;
    } else if (in_table) {
      found.back().columns.merge(quoted_names(line.substr(0, line.find('|', 1))));
    }
  }
  std::erase_if(found, [](const Section& section) { return section.views.empty(); });
  return found;
}

std::set<std::string> columns_of(SqlConnection& connection, const std::string& view) {
  std::set<std::string> names;
  connection.query(fmt::format("select name from pragma_table_info('{}')", view), {},
                   [&](const SqlRow& row) {
                     names.insert(text_at(row, 0));
                     return true;
                   });
  return names;
}

TEST(StoreDocument, ReportsTheColumnsOfEveryView) {
  const test::Scratch scratch;
  const auto connection = open_store(StoreAddress(scratch.path("store.db")), IfMissing::kCreate);
  std::set<std::string> told;
  for (const Section& section : sections()) {
    std::set<std::string> columns;
    for (const std::string& view : section.views) columns.merge(columns_of(*connection, view));
    EXPECT_EQ(section.columns, columns) << *section.views.begin();
    told.insert(section.views.begin(), section.views.end());
  }
  std::set<std::string> views;
  connection->query("select name from sqlite_master where type = 'view'", {},
                    [&](const SqlRow& row) {
                      views.insert(text_at(row, 0));
                      return true;
                    });
  EXPECT_EQ(told, views);
}

TEST(StoreDocument, HasQueriesThatSqliteTakes) {
  const test::Scratch scratch;
  const auto connection = open_store(StoreAddress(scratch.path("store.db")), IfMissing::kCreate);
  const auto blocks = blocks_for("SQLite");
  EXPECT_GE(blocks.size(), 5u);
  for (const std::string& block : blocks) {
    const std::string sql =
        std::regex_replace(block, std::regex("copy\\.db"), scratch.path("copy.db"));
    EXPECT_NO_THROW(connection->script(sql)) << sql;
  }
}

TEST(StoreDocument, HasQueriesThatPostgresTakes) {
  test::with_postgres([](test::PostgresServer& server) {
    const auto connection = open_store(server.address(), IfMissing::kCreate);
    const auto blocks = blocks_for("PostgreSQL");
    EXPECT_GE(blocks.size(), 5u);
    for (const std::string& block : blocks) EXPECT_NO_THROW(connection->script(block)) << block;
  });
}

}  // namespace
}  // namespace fieldcast
