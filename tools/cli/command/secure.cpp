#include "tools/cli/command/secure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <ostream>

#include "bridge/security/member_folder.hpp"
#include "core/base/json.hpp"
#include "tools/cli/command/base/command.hpp"
#include "tools/cli/command/base/command_options.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {
namespace {

using security::Authority;
using security::MemberCheck;
using security::MemberState;

std::string buses_text(const security::Member& member) {
  return fmt::format("{}", fmt::join(member.buses, ", "));
}

std::string shell_word(const std::string& text) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_-+=./:,@%").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), plain)) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + '\'';
}

ExitCode init(const SecureOptions& options, UtcTime now, std::ostream& out) {
  const Authority made = Authority::create(options.folder, options.protection, now);
  out << fmt::format(
      "{} is the authority now, until {}. Keep a copy of it, and let nobody read its keys.\n"
      "Next: fieldcast secure add bridge NAME --authority {}\n",
      options.folder, security::date_text(made.not_after()), shell_word(options.folder));
  return ExitCode::kOk;
}

ExitCode add(const SecureOptions& options, UtcTime now, std::ostream& out) {
  const std::string folder = Authority(options.folder).add(options.member, now, options.life);
  out << fmt::format(
      "{}: {} {}{}\nCopy this folder to the machine of {}, readable for its user only, and name it "
      "there: dds: {{ security: FOLDER }}, or --security FOLDER.\n",
      folder, to_text(options.member.role), options.member.name,
      options.member.buses.empty() ? "" : " for buses " + buses_text(options.member),
      options.member.name);
  return ExitCode::kOk;
}

ExitCode renew(const SecureOptions& options, UtcTime now, std::ostream& out) {
  Authority(options.folder).renew(options.member.name, now, options.life);
  out << fmt::format(
      "{0} is renewed. Copy {1}/members/{0} over its folder; a bridge takes it at a reload "
      "(SIGHUP), other programs when they start the next time.\n",
      options.member.name, options.folder);
  return ExitCode::kOk;
}

// Prints the faults of single members; the other members were processed.
ExitCode end_with(const std::vector<std::string>& faults, std::ostream& err) {
  print(err, faults);
  return faults.empty() ? ExitCode::kOk : ExitCode::kFound;
}

ExitCode revoke(const SecureOptions& options, UtcTime now, const Streams& to) {
  const auto faults = Authority(options.folder).revoke(options.member.name, now);
  to.out << fmt::format(
      "{} is revoked. Copy {}/{} into the folder of every other member, bridges first; a program "
      "refuses {} within a second, also one that runs.\n",
      options.member.name, options.folder, security::kRevoked, options.member.name);
  return end_with(faults, to.err);
}

Json state_json(const MemberState& state) {
  return {{"name", state.member.name},
          {"role", to_text(state.member.role)},
          {"buses", state.member.buses},
          {"subject", state.certificate.subject},
          {"serial", state.certificate.serial},
          {"until", security::date_text(state.certificate.not_after)},
          {"revoked", state.revoked}};
}

ExitCode show(const SecureOptions& options, UtcTime now, const Streams& to) {
  const security::MemberList all = Authority(options.folder).members();
  for (const MemberState& state : all.members) {
    if (options.json) {
      to.out << state_json(state).text() << '\n';
      continue;
    }
    const std::string end = security::date_text(state.certificate.not_after);
    const bool ended = state.certificate.not_after <= now;
    to.out << fmt::format("{:<24} {:<17} {:<24} {}\n", state.member.name,
                          to_text(state.member.role),
                          state.member.buses.empty() ? "every bus" : buses_text(state.member),
                          state.revoked ? "revoked"
                          : ended       ? "ended on " + end
                                        : "until " + end);
  }
  if (all.members.empty() && all.faults.empty() && !options.json)
    to.out << fmt::format("no members yet; fieldcast secure add bridge NAME --authority {}\n",
                          shell_word(options.folder));
  return end_with(all.faults, to.err);
}

MemberCheck check_authority(const std::string& folder, UtcTime now, std::ostream& out) {
  MemberCheck all;
  all.faults = security::authority_faults(folder);
  if (!all.faults.empty()) return all;
  const security::MemberList members = Authority(folder).members();
  for (const std::string& stray : members.strays) out << "stray: " << stray << '\n';
  all.faults = members.faults;
  for (const MemberState& state : members.members) {
    if (state.revoked) continue;
    MemberCheck one = security::check_member(state.folder, now);
    std::move(one.faults.begin(), one.faults.end(), std::back_inserter(all.faults));
    std::move(one.warnings.begin(), one.warnings.end(), std::back_inserter(all.warnings));
  }
  return all;
}

ExitCode check(const SecureOptions& options, UtcTime now, std::ostream& out) {
  std::error_code unknown;  // for an unreadable directory: check_member() reports it
  const bool authority = std::filesystem::exists(options.folder + "/members", unknown);
  const MemberCheck all = authority ? check_authority(options.folder, now, out)
                                    : security::check_member(options.folder, now);
  for (const std::string& fault : all.faults) out << "fault: " << fault << '\n';
  for (const std::string& warning : all.warnings) out << "soon: " << warning << '\n';
  if (all.faults.empty() && all.warnings.empty()) out << options.folder << ": in order\n";
  return all.faults.empty() ? ExitCode::kOk : ExitCode::kFound;
}

}  // namespace

ExitCode secure(const SecureOptions& options, UtcTime now, const Streams& to) {
  try {
    switch (options.action) {
      case SecureOptions::Action::kInit: return init(options, now, to.out);
      case SecureOptions::Action::kAdd: return add(options, now, to.out);
      case SecureOptions::Action::kRenew: return renew(options, now, to.out);
      case SecureOptions::Action::kRevoke: return revoke(options, now, to);
      case SecureOptions::Action::kShow: return show(options, now, to);
      case SecureOptions::Action::kCheck: return check(options, now, to.out);
    }
  } catch (const security::SecurityError& error) { to.err << error.what() << '\n'; }
  return ExitCode::kRejected;
}

namespace {

std::string roles_text() {
  std::string text;
  for (const auto& row : security::roles())
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", row.word, row.text);
  return text;
}

std::optional<std::string> read_role(const std::string& text, security::MemberRole& target) {
  const auto role = security::member_role_from(text);
  if (!role) return fmt::format("'{}' is unknown; {}", printable(text), roles_text());
  target = *role;
  return std::nullopt;
}

std::optional<std::string> read_protection(const std::string& text, security::Protection& target) {
  if (text != "encrypt" && text != "sign")
    return fmt::format("'{}' is unknown; encrypt or sign", printable(text));
  target = text == "sign" ? security::Protection::kSign : security::Protection::kEncrypt;
  return std::nullopt;
}

void describe_secure(CommandLine& line, SecureOptions& options) {
  CommandLine& init = line.command("init", "Make an authority in a new folder");
  init.text("DIR", options.folder, "The folder that is made").required();
  init.value(
      "--protect",
      [&options](const std::string& text) { return read_protection(text, options.protection); },
      "encrypt: nobody outside reads or changes anything; sign: nobody changes it (encrypt)");
  CommandLine& add = line.command("add", "Make the identity and the permissions of a member");
  add.value(
         "ROLE",
         [&options](const std::string& text) { return read_role(text, options.member.role); },
         roles_text())
      .required();
  add.text("NAME", options.member.name, "Of the member: letters, digits, '-' and '_'").required();
  add.texts("--bus", options.member.buses,
            "A plant commands the buses that match this pattern only; may be repeated");
  CommandLine& renew =
      line.command("renew", "Make a new certificate for a member, which keeps its key");
  CommandLine& revoke = line.command("revoke", "Shut a member out");
  for (CommandLine* one : {&renew, &revoke})
    one->text("NAME", options.member.name, "Of the member").required();
  for (CommandLine* one : {&add, &renew}) {
    one->duration("--valid", options.life, security::kDay,
                  "How long the certificate is good: 365d");
  }
  CommandLine& show = line.command("show", "List the members");
  show.flag("--json", options.json, "JSON lines");
  for (CommandLine* one : {&add, &renew, &revoke, &show})
    one->text("--authority", options.folder, "The folder of the authority").show_default();
  CommandLine& check =
      line.command("check", "Say what is wrong with a folder, and what ends within 30 days");
  check.text("DIR", options.folder, "Of a member or of the authority").show_default();
  set_when_given(init, options.action, SecureOptions::Action::kInit);
  set_when_given(add, options.action, SecureOptions::Action::kAdd);
  set_when_given(renew, options.action, SecureOptions::Action::kRenew);
  set_when_given(revoke, options.action, SecureOptions::Action::kRevoke);
  set_when_given(show, options.action, SecureOptions::Action::kShow);
  set_when_given(check, options.action, SecureOptions::Action::kCheck);
}

}  // namespace

CommandRow secure_command() {
  return command_row("secure", "Make identities and permissions for DDS Security; needs no bridge",
                     describe_secure, [](const SecureOptions& options, const Streams& to) {
                       // Delays signals for a fraction of a second, so that no key directory is
                       // left incomplete.
                       const Interrupt interrupt;
                       return secure(options, utc_now(), to);
                     });
}

}  // namespace fieldcast::cli
