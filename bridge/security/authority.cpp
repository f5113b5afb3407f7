#include "bridge/security/authority.hpp"

#include <algorithm>
#include <filesystem>

#include "bridge/security/file_access.hpp"
#include "bridge/security/member_folder.hpp"

namespace fieldcast::security {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kIdentityCaKey = "identity-ca.key";
constexpr std::string_view kPermissionsCaKey = "permissions-ca.key";
constexpr std::string_view kMembers = "members";
constexpr std::string_view kIssued = "issued";
// Clocks of a plant differ, and Fast DDS 2.9.1 parses the dates of permissions as local time.
constexpr Duration kBackdated = kDay;

UtcTime operator+(UtcTime time, Duration duration) { return {time.nanoseconds + duration.count()}; }

std::string joined(const std::string& folder, std::string_view file) {
  return folder + '/' + std::string(file);
}

Validity from_now(UtcTime now, Duration life) { return {now + -kBackdated, now + life}; }

// Returns the entries of a folder, sorted by name. Throws SecurityError if it cannot be read.
std::vector<fs::path> entries_of(const std::string& folder) {
  std::error_code failed;
  std::vector<fs::path> all;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    all.push_back(at->path());
  if (failed) throw SecurityError("cannot read " + folder + ": " + failed.message());
  std::ranges::sort(all);
  return all;
}

// Removes an unfinished result, unless it is kept: a file, a folder, or the contents of a folder.
class Unfinished {
 public:
  enum class Part : std::uint8_t { kAll, kWhatIsInIt };
  explicit Unfinished(std::string path, Part part = Part::kAll)
      : path_(std::move(path)), part_(part) {}
  ~Unfinished() {
    if (kept_) return;
    std::error_code none;
    if (part_ == Part::kAll) {
      fs::remove_all(path_, none);
      return;
    }
    for (fs::directory_iterator at(path_, none), end; !none && at != end; at.increment(none))
      fs::remove_all(at->path(), none);
  }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;
  void keep() { kept_ = true; }

 private:
  const std::string path_;
  const Part part_;
  bool kept_ = false;
};

// Reads a certificate; errors include the path.
CertificateFacts certificate_in(const std::string& path) {
  const std::string text = read_file(path);
  if (text.empty()) throw SecurityError(path + " is empty");
  try {
    return read_certificate(text);
  } catch (const SecurityError& error) { throw SecurityError(path + ": " + error.what()); }
}

}  // namespace

Authority Authority::create(const std::string& folder, Protection protection, UtcTime now) {
  std::error_code none;
  const bool was_there = fs::exists(folder, none);
  if (was_there && !(fs::is_directory(folder, none) && fs::is_empty(folder, none)))
    throw SecurityError(folder + " is there already; nothing was changed");
  if (const std::string open = open_to_change(folder); !open.empty()) throw SecurityError(open);
  if (!was_there) make_folder(folder);
  Unfinished made(folder, was_there ? Unfinished::Part::kWhatIsInIt : Unfinished::Part::kAll);
  const Validity validity = from_now(now, kAuthorityLife);
  const Identity identities = new_authority("identities", validity);
  const Identity permissions = new_authority("permissions", validity);
  write_new(joined(folder, kIdentityCaKey), identities.key, kOwnerOnly);
  write_new(joined(folder, kIdentityCa), identities.certificate, kForAll);
  write_new(joined(folder, kPermissionsCaKey), permissions.key, kOwnerOnly);
  write_new(joined(folder, kPermissionsCa), permissions.certificate, kForAll);
  write_new(joined(folder, kRevoked), empty_revocations(identities, now), kForAll);
  make_folder(joined(folder, kIssued));
  make_folder(joined(folder, kMembers));
  write_new(joined(folder, kGovernance), sign(permissions, governance_text(protection)), kForAll);
  made.keep();
  return Authority(folder);
}

Authority::Authority(std::string folder) : folder_(std::move(folder)) {
  while (folder_.size() > 1 && folder_.ends_with('/')) folder_.pop_back();
  if (const auto faults = authority_faults(folder_); !faults.empty())
    throw SecurityError(faults.front());
}

std::string Authority::path(std::string_view file) const { return joined(folder_, file); }

std::string Authority::member_folder(const std::string& name) const {
  return path(kMembers) + '/' + name;
}

Identity Authority::identities() const {
  return {read_file(path(kIdentityCa)), read_key(path(kIdentityCaKey))};
}

Identity Authority::permissions() const {
  return {read_file(path(kPermissionsCa)), read_key(path(kPermissionsCaKey))};
}

std::string Authority::place_of(const std::string& certificate) const {
  return path(kIssued) + '/' + read_certificate(certificate).serial + ".pem";
}

std::string Authority::issue_for(const Member& member, const std::string& key, UtcTime now,
                                 Duration life) const {
  std::string certificate = issue(identities(), key, subject_for(member), from_now(now, life));
  write_new(place_of(certificate), certificate, kForAll);
  return certificate;
}

Grant Authority::grant(const Member& member, const std::string& certificate) const {
  const CertificateFacts facts = read_certificate(certificate);
  return {member, facts.subject, facts.not_before, facts.not_after};
}

std::string Authority::add(const Member& member, UtcTime now, Duration life) {
  if (const std::string fault = fault_of(member); !fault.empty()) throw SecurityError(fault);
  const std::string folder = member_folder(member.name);
  const std::string list = read_file(path(kRevoked));
  for (const std::string& one : issued_to(member.name).certificates) {
    if (is_revoked(list, one))
      throw SecurityError(member.name + " is revoked; add a member with another name");
  }
  std::error_code none;
  if (fs::exists(folder, none)) {
    throw SecurityError("there is a member " + member.name +
                        " already; fieldcast secure renew makes a new certificate");
  }
  const std::string key = new_key();
  const std::string certificate = issue_for(member, key, now, life);
  Unfinished issued(place_of(certificate));  // not handed out yet
  const std::string permitted = sign(permissions(), permissions_text(grant(member, certificate)));
  const std::string growing = folder + std::string(kUnfinished);
  fs::remove_all(growing, none);  // left by an interrupted run
  make_folder(growing);
  Unfinished half(growing);
  write_new(joined(growing, kIdentityKey), key, kOwnerOnly);
  write_new(joined(growing, kIdentity), certificate, kForAll);
  write_new(joined(growing, kPermissions), permitted, kForAll);
  for (const std::string_view shared : {kIdentityCa, kPermissionsCa, kGovernance, kRevoked})
    write_new(joined(growing, shared), read_file(path(shared)), kForAll);
  write_new(joined(growing, kMember), member_text(member), kForAll);
  move_new(growing, folder);
  half.keep();
  issued.keep();
  return folder;
}

MemberState Authority::state_of(const std::string& name) const {
  const std::string folder = member_folder(name);
  std::error_code none;
  if (!fault_of({MemberRole::kStation, name, {}}).empty() || !fs::exists(folder, none))
    throw SecurityError("there is no member " + name);
  auto member = member_from(read_file(joined(folder, kMember)));
  if (!member) throw SecurityError(joined(folder, kMember) + ": " + member.error());
  CertificateFacts facts = certificate_in(joined(folder, kIdentity));
  const bool revoked = is_revoked(read_file(path(kRevoked)), read_file(joined(folder, kIdentity)));
  return {*std::move(member), folder, std::move(facts), revoked};
}

void Authority::renew(const std::string& name, UtcTime now, Duration life) {
  const MemberState state = state_of(name);
  if (state.revoked) throw SecurityError(name + " is revoked; add a member with another name");
  const std::string key = read_file(joined(state.folder, kIdentityKey));
  const std::string certificate = issue_for(state.member, key, now, life);
  Unfinished issued(place_of(certificate));
  std::vector<NewText> files{
      {joined(state.folder, kIdentity), certificate, kForAll},
      {joined(state.folder, kPermissions),
       sign(permissions(), permissions_text(grant(state.member, certificate))), kForAll}};
  for (const std::string_view shared : {kGovernance, kRevoked})
    files.push_back({joined(state.folder, shared), read_file(path(shared)), kForAll});
  replace_all(files);
  issued.keep();
}

Authority::Issued Authority::issued_to(const std::string& name) const {
  Issued found;
  const auto take = [&](const fs::path& file) {
    const auto subject = subject_from(certificate_in(file).slashed);
    if (subject && subject->name == name) found.certificates.push_back(read_file(file));
  };
  for (const fs::path& file : entries_of(path(kIssued))) {
    if (file.extension() != ".pem") continue;
    try {
      take(file);
    } catch (const SecurityError& error) { found.faults.emplace_back(error.what()); }
  }
  // Includes the certificate in the member's folder, if its copy in `issued` cannot be read.
  const std::string own = member_folder(name) + '/' + std::string(kIdentity);
  std::error_code none;
  if (found.faults.empty() || !fault_of({MemberRole::kStation, name, {}}).empty() ||
      !fs::exists(own, none))
    return found;
  try {
    take(own);
  } catch (const SecurityError&) {}  // members() reports it
  return found;
}

// A failure at one member does not stop the copies to the others.
std::vector<std::string> Authority::copy_revocations() const {
  const std::string list = read_file(path(kRevoked));
  MemberList all = members();
  for (const MemberState& member : all.members) {
    try {
      replace(joined(member.folder, kRevoked), list, kForAll);
    } catch (const SecurityError& error) { all.faults.emplace_back(error.what()); }
  }
  return std::move(all.faults);
}

std::vector<std::string> Authority::revoke(const std::string& name, UtcTime now) {
  const Issued issued = issued_to(name);
  if (issued.certificates.empty()) {
    throw SecurityError("there is no member " + name +
                        (issued.faults.empty() ? "" : "; " + issued.faults.front()));
  }
  std::string list = read_file(path(kRevoked));
  bool more = false;
  for (const std::string& certificate : issued.certificates) {
    if (is_revoked(list, certificate)) continue;
    list = security::revoke(identities(), list, certificate, now);
    more = true;
  }
  if (more) replace(path(kRevoked), list, kForAll);
  // Also copies to members that an earlier, failed run has left out.
  std::vector<std::string> faults = copy_revocations();
  if (!more) throw SecurityError(name + " is revoked already");
  return faults;
}

MemberList Authority::members() const {
  MemberList all;
  all.faults = issued_to({}).faults;
  for (const fs::path& entry : entries_of(path(kMembers))) {
    const std::string name = entry.filename().string();
    std::error_code none;
    const bool has_files = fs::exists(entry / kMember, none) || fs::exists(entry / kIdentity, none);
    if (!fault_of({MemberRole::kStation, name, {}}).empty() || !has_files) {
      all.strays.push_back(entry.string() + " is no member's folder; nothing is done with it");
      continue;
    }
    try {
      MemberState state = state_of(name);
      if (state.member.name == name)
        all.members.push_back(std::move(state));
      else
        all.strays.push_back(entry.string() + " is a copy of the member " + state.member.name +
                             "; nothing is done with it");
    } catch (const SecurityError& error) { all.faults.emplace_back(error.what()); }
  }
  return all;
}

UtcTime Authority::not_after() const {
  return std::min(read_certificate(read_file(path(kIdentityCa))).not_after,
                  read_certificate(read_file(path(kPermissionsCa))).not_after);
}

namespace {

void check_dates(const std::string& what, const CertificateFacts& facts, UtcTime now,
                 const std::string& remedy, MemberCheck& check) {
  if (now < facts.not_before) {
    check.faults.push_back(what + " begins on " + date_text(facts.not_before) +
                           ": is the clock of this machine right?");
  } else if (facts.not_after <= now) {
    check.faults.push_back(what + " ended on " + date_text(facts.not_after) + "; " + remedy);
  } else if (facts.not_after < now + kWarnAhead) {
    check.warnings.push_back(what + " ends on " + date_text(facts.not_after) + "; " + remedy);
  }
}

// Throws SecurityError with the path of the first file with wrong contents.
void check_forms(const std::string& folder) {
  const auto text = [&folder](std::string_view file) { return read_file(joined(folder, file)); };
  for (const std::string_view file : {kIdentityCa, kPermissionsCa, kIdentity})
    (void)certificate_in(joined(folder, file));
  const auto understood = [&folder](std::string_view file, const auto& understand) {
    try {
      understand();
    } catch (const SecurityError& error) {
      throw SecurityError(joined(folder, file) + ": " + error.what());
    }
  };
  const std::string identity = text(kIdentity);
  understood(kIdentityKey, [&] { (void)is_key_of(text(kIdentityKey), identity); });
  understood(kRevoked, [&] { (void)is_revoked(text(kRevoked), identity); });
}

void check_files(const std::string& folder, const Member& member, UtcTime now, MemberCheck& check) {
  check_forms(folder);
  const auto text = [&folder](std::string_view file) { return read_file(joined(folder, file)); };
  const auto fault = [&](bool wrong, const std::string& line) {
    if (wrong) check.faults.push_back(folder + ": " + line);
  };
  const std::string identity_ca = text(kIdentityCa), identity = text(kIdentity);
  const std::string permissions_ca = text(kPermissionsCa);
  const std::string remedy =
      "fieldcast secure renew " + member.name + ", and copy its folder to this machine again";
  check_dates(folder + ": the certificate", read_certificate(identity), now, remedy, check);
  check_dates(folder + ": the authority of identities", read_certificate(identity_ca), now,
              "make a new authority", check);
  fault(!is_issued_by(identity_ca, identity), "the certificate is of another authority");
  fault(!is_key_of(text(kIdentityKey), identity), "the key is of another certificate");
  fault(is_revoked(text(kRevoked), identity), "this member is revoked");
  fault(verified_text(permissions_ca, text(kGovernance)).empty(),
        "governance.p7s is of another authority, or was changed");
  const std::string permitted = verified_text(permissions_ca, text(kPermissions));
  fault(permitted.empty(), "permissions.p7s is of another authority, or was changed");
  fault(!permitted.empty() && permitted.find("<subject_name>" + read_certificate(identity).subject +
                                             '<') == std::string::npos,
        "permissions.p7s is for another member");
}

}  // namespace

MemberCheck check_member(const std::string& folder, UtcTime now) {
  MemberCheck check;
  const auto member = read_member(folder);
  if (!member) {
    check.faults.push_back(member.error());
    return check;
  }
  try {
    check_files(folder, *member, now, check);
  } catch (const SecurityError& error) { check.faults.emplace_back(error.what()); }
  return check;
}

std::vector<std::string> authority_faults(const std::string& folder) {
  constexpr std::string_view kKeys[] = {kIdentityCaKey, kPermissionsCaKey};
  constexpr std::string_view kParts[] = {kIdentityCaKey, kIdentityCa, kPermissionsCaKey,
                                         kPermissionsCa, kGovernance, kRevoked,
                                         kIssued,        kMembers};
  for (const std::string_view part : kParts) {
    std::error_code failed;
    if (fs::exists(joined(folder, part), failed)) continue;
    if (failed) return {folder + ": cannot be read by this user: " + failed.message()};
    return {folder + " is no authority's folder: " + std::string(part) +
            " is missing; --authority names one, fieldcast secure init makes one"};
  }
  std::vector<std::string> faults;
  const auto note = [&faults](std::string fault) {
    if (!fault.empty()) faults.push_back(std::move(fault));
  };
  note(open_to_change(folder));
  for (const std::string_view part : kParts) {
    if (std::ranges::find(kKeys, part) == std::end(kKeys))
      note(open_to_change(joined(folder, part)));
  }
  for (const std::string_view key : kKeys) {
    try {
      (void)read_key(joined(folder, key));
    } catch (const SecurityError& error) { note(error.what()); }
  }
  return faults;
}

MemberCheck check_program(const std::string& folder, bool is_bridge, UtcTime now) {
  MemberCheck check = check_member(folder, now);
  const auto member = read_member(folder);
  if (!member || (member->role == MemberRole::kBridge) == is_bridge) return check;
  check.faults.push_back(
      is_bridge
          ? folder + ": a " + std::string(to_text(member->role)) +
                " is no bridge; fieldcast secure add bridge NAME"
          : folder + " makes this program the bridge " + member->name +
                ", which neither reads nor commands; name the folder of a station or a plant");
  return check;
}

std::optional<UtcTime> end_of_member(const std::string& folder) {
  try {
    return read_certificate(read_file(joined(folder, kIdentity))).not_after;
  } catch (const SecurityError&) { return std::nullopt; }
}

std::string date_text(UtcTime time) { return xml_time(time).substr(0, 10); }

}  // namespace fieldcast::security
