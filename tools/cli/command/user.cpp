#include "tools/cli/command/user.hpp"

#include <fmt/format.h>

#include <ostream>

#include "bridge/store/event_table.hpp"
#include "bridge/store/users/authenticator.hpp"
#include "bridge/store/users/user_table.hpp"
#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/terminal/console.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/record_view.hpp"

namespace fieldcast::cli {

namespace {

constexpr std::uint32_t kMostDays = 3650;

void audit_access(SqlConnection& store, const char* what, const std::string& name,
                  std::string result) {
  EventTable(store).insert({.at = utc_now(),
                            .who = "command line",
                            .what = what,
                            .target = name,
                            .result = std::move(result)});
}

ExitCode remove_access(bool removed, SqlConnection& store, const std::string& kind,
                       const std::string& name, std::ostream& err) {
  if (!removed) {
    err << "there is no " << kind << ' ' << printable(name) << '\n';
    return ExitCode::kNothing;
  }
  audit_access(store, (kind + " remove").c_str(), name, "done");
  return ExitCode::kOk;
}

template <typename Records>
ExitCode list_access(const Records& records, bool json, const std::vector<std::string>& lines,
                     const char* nothing, const Streams& to) {
  if (json) {
    for (const auto& record : records) to.out << record_json(record).text() << '\n';
  } else if (!records.empty()) {
    print(to.out, lines);
  }
  to.out.flush();
  if (records.empty()) to.err << nothing << '\n';
  return records.empty() ? ExitCode::kNothing : ExitCode::kOk;
}

ExitCode add_token(const TokenOptions& options, SqlConnection& store, const Streams& to) {
  if (!fault_of_user_name(options.name).empty()) {
    to.err << "a token's name has 1 to 64 letters, digits, '-', '_', '.', '@'\n";
    return ExitCode::kUsage;
  }
  const UtcTime now = utc_now();
  const Duration length = std::chrono::hours{24} * options.days;
  const Token made{options.name, now, UtcTime{now.nanoseconds + length.count()}};
  std::string secret = make_token();
  if (!TokenTable(store).add(made, secret)) {
    to.err << "there is a token " << options.name << " already, or there are "
           << TokenTable::kMaxTokens << "; remove one first\n";
    return ExitCode::kRejected;
  }
  audit_access(store, "token add", options.name, "until " + utc_text(made.ends_at));
  to.out << secret << '\n';
  to.out.flush();
  wipe(secret);
  to.err << "It reads everything until " << utc_text(made.ends_at)
         << ". Keep it now: it is not shown again.\n";
  return ExitCode::kOk;
}

ExitCode add_user(const UserOptions& options, SqlConnection& store, const Streams& to) {
  auto password = new_password(options.password_file, to.in, to.err);
  std::string fault = !password ? password.error() : fault_of_user_name(options.name);
  if (fault.empty()) fault = fault_of_password(password->text());
  if (!fault.empty()) {
    to.err << fault << '\n';
    return ExitCode::kUsage;
  }
  if (!UserTable(store).add(options.name, options.role, password->text(), utc_now())) {
    to.err << "there is a user " << options.name << " already; remove it first\n";
    return ExitCode::kRejected;
  }
  audit_access(store, "user add", options.name, std::string(to_text(options.role)));
  return ExitCode::kOk;
}

// Users and tokens may be added before the first start of the bridge or station.
IfMissing if_missing(AccessAction action) {
  return action == AccessAction::kAdd ? IfMissing::kCreate : IfMissing::kFail;
}

}  // namespace

ExitCode token(const TokenOptions& options, const Streams& to) {
  return in_store(options.source, to.err, if_missing(options.action), [&](SqlConnection& store) {
    if (options.action == AccessAction::kAdd) return add_token(options, store, to);
    TokenTable table(store);
    if (options.action == AccessAction::kRemove)
      return remove_access(table.remove(options.name), store, "token", options.name, to.err);
    const auto tokens = table.list();
    return list_access(tokens, options.json, token_lines(tokens, utc_now(), to.wide_screen()),
                       "there are no tokens; fieldcast token add NAME --days 365", to);
  });
}

ExitCode user(const UserOptions& options, const Streams& to) {
  return in_store(options.source, to.err, if_missing(options.action), [&](SqlConnection& store) {
    if (options.action == AccessAction::kAdd) return add_user(options, store, to);
    UserTable table(store);
    if (options.action == AccessAction::kRemove)
      return remove_access(table.remove(options.name), store, "user", options.name, to.err);
    const auto users = table.list();
    return list_access(users, options.json, user_lines(users, to.wide_screen()),
                       "there are no users; fieldcast user add NAME --role programmer", to);
  });
}

namespace {

// Adds the options that all actions of `token` and `user` share.
void describe_actions(AccessOptions& options, CommandLine& add, CommandLine& list,
                      CommandLine& remove, const std::string& of) {
  list.flag("--json", options.json, "JSON lines");
  remove.text("NAME", options.name, of).required();
  set_when_given(add, options.action, AccessAction::kAdd);
  set_when_given(list, options.action, AccessAction::kList);
  set_when_given(remove, options.action, AccessAction::kRemove);
  for (CommandLine* line : {&add, &list, &remove}) add_store(*line, options.source);
}

void describe_token(CommandLine& line, TokenOptions& options) {
  CommandLine& add =
      line.command("add", "Make a token and print it; the store keeps its hash only");
  add.text("NAME", options.name, "Letters, digits, '-', '_', '.', '@'").required();
  add.number("--days", options.days, 1, kMostDays, "How long it lets in").required();
  CommandLine& list = line.command("list", "List them with their ends");
  CommandLine& remove = line.command("remove", "Remove a token; who uses it is let in no more");
  describe_actions(options, add, list, remove, "Of the token");
}

void describe_user(CommandLine& line, UserOptions& options) {
  CommandLine& add = line.command(
      "add", "Add a user; the password is asked for, or the first line of the standard input");
  add.text("NAME", options.name, "Letters, digits, '-', '_', '.', '@'").required();
  add.value(
      "--role",
      [&options](const std::string& text) -> std::optional<std::string> {
        const auto role = role_from(text);
        if (!role)
          return fmt::format("'{}' is unknown; viewer, operator, programmer or engineer",
                             printable(text));
        options.role = *role;
        return std::nullopt;
      },
      "viewer, operator, programmer or engineer (viewer)");
  add.text("--password-file", options.password_file,
           "The password is its first line; readable by you alone (chmod 600)");
  CommandLine& list = line.command("list", "List them with their roles");
  CommandLine& remove = line.command("remove", "Remove a user");
  describe_actions(options, add, list, remove, "Of the user");
}

}  // namespace

CommandRow token_command() {
  return command_row("token",
                     "Add, list and remove tokens, which read at a station; needs no bridge",
                     describe_token, token);
}

CommandRow user_command() {
  return command_row("user", "Add, list and remove who may log in; needs no bridge", describe_user,
                     user);
}

}  // namespace fieldcast::cli
