#include "tools/forward/command/command_journal.hpp"

namespace fieldcast::forward {

namespace {

constexpr const char* kTables = R"(
create table if not exists commands(
  user text not null, id text not null, taken_at integer not null, response text,
  primary key(user, id)) without rowid;
)";

}  // namespace

CommandJournal::CommandJournal(const std::string& path, const std::string& unknown)
    : connection_(open_sqlite(path, IfMissing::kCreate)) {
  connection_->script(kTables);
  connection_->execute("update commands set response = $1 where response is null", SqlRow{unknown});
}

CommandJournal::Entry CommandJournal::begin(const std::string& user, const std::string& id,
                                            UtcTime now) {
  connection_->execute("delete from commands where taken_at < $1",
                       SqlRow{saturated_difference(now.nanoseconds, kKeep.count())});
  const std::uint64_t added =
      connection_->execute("insert or ignore into commands(user, id, taken_at) values($1, $2, $3)",
                           SqlRow{user, id, now.nanoseconds});
  if (added == 1) return {.is_new = true, .response = {}};
  return {.is_new = false, .response = response(user, id)};
}

void CommandJournal::complete(const std::string& user, const std::string& id,
                              const std::string& response) {
  connection_->execute("update commands set response = $1 where user = $2 and id = $3",
                       SqlRow{response, user, id});
}

std::optional<std::string> CommandJournal::response(const std::string& user,
                                                    const std::string& id) {
  std::optional<std::string> found;
  connection_->query(
      "select response from commands where user = $1 and id = $2 and response is "
      "not null",
      {user, id}, [&found](const SqlRow& row) {
        found = text_at(row, 0);
        return false;
      });
  return found;
}

}  // namespace fieldcast::forward
