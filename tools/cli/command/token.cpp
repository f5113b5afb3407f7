#include "tools/cli/command/token.hpp"

#include <fmt/format.h>

#include <ostream>

#include "bridge/store/event_table.hpp"
#include "bridge/store/users/password.hpp"
#include "bridge/store/users/token_table.hpp"
#include "bridge/store/users/user_table.hpp"
#include "tools/cli/command/base/command.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/terminal/clock.hpp"
#include "tools/cli/terminal/console.hpp"
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

}  // namespace fieldcast::cli
