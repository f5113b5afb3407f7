#include "tools/cli/command/user.hpp"

#include <fmt/format.h>

#include <ostream>

#include "bridge/store/event_table.hpp"
#include "bridge/store/users/authenticator.hpp"
#include "bridge/store/users/user_table.hpp"
#include "tools/cli/command/base/command.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/terminal/console.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/record_view.hpp"

namespace fieldcast::cli {

namespace {

constexpr std::uint32_t kMostDays = 3650;

void note_token(SqlConnection& connection, const char* what, const std::string& name,
                std::string result) {
  EventTable(connection)
      .insert({.at = utc_now(),
               .who = "command line",
               .what = what,
               .target = name,
               .result = std::move(result)});
}

ExitCode add_token(const TokenOptions& options, SqlConnection& connection, std::ostream& out,
                   std::ostream& err) {
  if (!fault_of_user_name(options.name).empty()) {
    err << "a token's name has 1 to 64 letters, digits, '-', '_', '.', '@'\n";
    return ExitCode::kUsage;
  }
  const UtcTime now = utc_now();
  const Duration length = std::chrono::hours{24} * options.days;
  const Token made{options.name, now, UtcTime{now.nanoseconds + length.count()}};
  std::string secret = make_token();
  if (!TokenTable(connection).add(made, secret)) {
    err << "there is a token " << options.name << " already, or there are "
        << TokenTable::kMaxTokens << "; remove one first\n";
    return ExitCode::kRejected;
  }
  note_token(connection, "token add", options.name, "until " + utc_text(made.ends_at));
  out << secret << '\n';
  out.flush();
  wipe(secret);
  err << "It reads everything until " << utc_text(made.ends_at)
      << ". Keep it now: it is not shown again.\n";
  return ExitCode::kOk;
}

ExitCode remove_token(const TokenOptions& options, SqlConnection& connection, std::ostream& err) {
  if (!TokenTable(connection).remove(options.name)) {
    err << "there is no token " << printable(options.name) << '\n';
    return ExitCode::kNothing;
  }
  note_token(connection, "token remove", options.name, "done");
  return ExitCode::kOk;
}

ExitCode list_tokens(const TokenOptions& options, SqlConnection& connection, std::ostream& out,
                     std::ostream& err) {
  const auto tokens = TokenTable(connection).list();
  if (options.json) {
    for (const Token& token : tokens) out << record_json(token).text() << '\n';
  } else if (!tokens.empty()) {
    for (const auto& line : token_lines(tokens, utc_now(), {0, 0, output_screen().colour}))
      out << line << '\n';
  }
  out.flush();
  if (tokens.empty()) err << "there are no tokens; fieldcast token add NAME --days 365\n";
  return tokens.empty() ? ExitCode::kNothing : ExitCode::kOk;
}

}  // namespace

ExitCode token(const TokenOptions& options, std::ostream& out, std::ostream& err) {
  const auto address = resolve(options.source);
  if (!address) {
    err << address.error() << '\n';
    return ExitCode::kUsage;
  }
  // Tokens may be added before the first start of the station.
  const bool adds = options.action == TokenOptions::Action::kAdd;
  const auto connection = open_store(*address, adds ? IfMissing::kCreate : IfMissing::kFail);
  switch (options.action) {
    case TokenOptions::Action::kAdd: return add_token(options, *connection, out, err);
    case TokenOptions::Action::kRemove: return remove_token(options, *connection, err);
    case TokenOptions::Action::kList: return list_tokens(options, *connection, out, err);
  }
  return ExitCode::kUsage;
}

namespace {

class TokenCommand final : public CommandWith<TokenOptions> {
 public:
  void describe(CommandLine& line) override {
    CommandLine& add =
        line.command("add", "Make a token and print it; the store keeps its hash only");
    add.text("NAME", options_.name, "Letters, digits, '-', '_', '.', '@'").required();
    add.number("--days", options_.days, 1, kMostDays, "How long it lets in").required();
    CommandLine& list = line.command("list", "List them with their ends");
    list.flag("--json", options_.json, "JSON lines");
    CommandLine& remove = line.command("remove", "Remove a token; who uses it is let in no more");
    remove.text("NAME", options_.name, "Of the token").required();
    describe_action(add, TokenOptions::Action::kAdd);
    describe_action(list, TokenOptions::Action::kList);
    describe_action(remove, TokenOptions::Action::kRemove);
  }
  ExitCode run(const Streams& streams) override {
    return token(options_, streams.out, streams.err);
  }

 private:
  void describe_action(CommandLine& line, TokenOptions::Action action) {
    line.when_given([this, action]() -> std::optional<CommandLine::Fault> {
      options_.action = action;
      return std::nullopt;
    });
    add_store(line, options_.source);
  }
};

}  // namespace

CommandEntry token_command();
CommandEntry token_command() {
  return {"token", "Add, list and remove tokens, which read at a station; needs no bridge",
          make_command<TokenCommand>};
}

namespace {

void note(SqlConnection& connection, const char* what, const std::string& name,
          std::string result) {
  EventTable(connection)
      .insert({.at = utc_now(),
               .who = "command line",
               .what = what,
               .target = name,
               .result = std::move(result)});
}

ExitCode add(const UserOptions& options, SqlConnection& connection, std::istream& in,
             std::ostream& err) {
  auto password = new_password(options.password_file, in, err);
  std::string fault = !password ? password.error() : fault_of_user_name(options.name);
  if (fault.empty()) fault = fault_of_password(password->text());
  if (!fault.empty()) {
    err << fault << '\n';
    return ExitCode::kUsage;
  }
  const bool added =
      UserTable(connection).add(options.name, options.role, password->text(), utc_now());
  if (!added) {
    err << "there is a user " << options.name << " already; remove it first\n";
    return ExitCode::kRejected;
  }
  note(connection, "user add", options.name, std::string(to_text(options.role)));
  return ExitCode::kOk;
}

ExitCode remove(const UserOptions& options, SqlConnection& connection, std::ostream& err) {
  if (!UserTable(connection).remove(options.name)) {
    err << "there is no user " << printable(options.name) << '\n';
    return ExitCode::kNothing;
  }
  note(connection, "user remove", options.name, "done");
  return ExitCode::kOk;
}

ExitCode list(const UserOptions& options, SqlConnection& connection, std::ostream& out,
              std::ostream& err) {
  const auto users = UserTable(connection).list();
  if (options.json) {
    for (const User& user : users) out << record_json(user).text() << '\n';
  } else if (!users.empty()) {
    for (const auto& line : user_lines(users, {0, 0, output_screen().colour})) out << line << '\n';
  }
  out.flush();
  if (users.empty()) err << "there are no users; fieldcast user add NAME --role programmer\n";
  return users.empty() ? ExitCode::kNothing : ExitCode::kOk;
}

}  // namespace

ExitCode user(const UserOptions& options, std::istream& in, std::ostream& out, std::ostream& err) {
  const auto address = resolve(options.source);
  if (!address) {
    err << address.error() << '\n';
    return ExitCode::kUsage;
  }
  // Users may be added before the first start of the bridge.
  const bool adds = options.action == UserOptions::Action::kAdd;
  const auto connection = open_store(*address, adds ? IfMissing::kCreate : IfMissing::kFail);
  switch (options.action) {
    case UserOptions::Action::kAdd: return add(options, *connection, in, err);
    case UserOptions::Action::kRemove: return remove(options, *connection, err);
    case UserOptions::Action::kList: return list(options, *connection, out, err);
  }
  return ExitCode::kUsage;
}

namespace {

class UserCommand final : public CommandWith<UserOptions> {
 public:
  void describe(CommandLine& line) override {
    CommandLine& add = line.command(
        "add", "Add a user; the password is asked for, or the first line of the standard input");
    add.text("NAME", options_.name, "Letters, digits, '-', '_', '.', '@'").required();
    add.value(
        "--role", [this](const std::string& text) { return read_role(text); },
        "viewer, operator or programmer (viewer)");
    add.text("--password-file", options_.password_file,
             "The password is its first line; readable by you alone (chmod 600)");
    CommandLine& list = line.command("list", "List them with their roles");
    list.flag("--json", options_.json, "JSON lines");
    CommandLine& remove = line.command("remove", "Remove a user");
    remove.text("NAME", options_.name, "Of the user").required();
    describe_action(add, UserOptions::Action::kAdd);
    describe_action(list, UserOptions::Action::kList);
    describe_action(remove, UserOptions::Action::kRemove);
  }
  ExitCode run(const Streams& streams) override {
    return user(options_, streams.in, streams.out, streams.err);
  }

 private:
  void describe_action(CommandLine& line, UserOptions::Action action) {
    line.when_given([this, action]() -> std::optional<CommandLine::Fault> {
      options_.action = action;
      return std::nullopt;
    });
    add_store(line, options_.source);
  }
  std::optional<std::string> read_role(const std::string& text) {
    const auto role = role_from(text);
    if (!role)
      return fmt::format("'{}' is unknown; viewer, operator or programmer", printable(text));
    options_.role = *role;
    return std::nullopt;
  }
};

}  // namespace

CommandEntry user_command();
CommandEntry user_command() {
  return {"user", "Add, list and remove who may log in; needs no bridge",
          make_command<UserCommand>};
}

}  // namespace fieldcast::cli
