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
// Clocks of a plant differ, and Fast DDS 2.9.1 takes the dates of permissions for local time.
constexpr Duration kBackdated = kDay;

UtcTime operator+(UtcTime time, Duration duration) { return {time.nanoseconds + duration.count()}; }

std::string joined(const std::string& folder, std::string_view file) {
  return folder + '/' + std::string(file);
}

Validity from_now(UtcTime now, Duration life) { return {now + -kBackdated, now + life}; }

}  // namespace

Authority Authority::create(const std::string& folder, Protection protection, UtcTime now) {
  std::error_code none;
  if (fs::exists(folder, none) && !(fs::is_directory(folder, none) && fs::is_empty(folder, none)))
    throw SecurityError(folder + " is there already; nothing was changed");
  if (!fs::exists(folder, none)) make_folder(folder);
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
  return Authority(folder);
}

Authority::Authority(std::string folder) : folder_(std::move(folder)) {
  while (folder_.size() > 1 && folder_.ends_with('/')) folder_.pop_back();
  std::error_code none;
  for (const std::string_view file : {kIdentityCaKey, kIdentityCa, kPermissionsCaKey,
                                      kPermissionsCa, kGovernance, kRevoked, kIssued, kMembers}) {
    if (!fs::exists(path(file), none)) {
      throw SecurityError(folder_ + " is no authority's folder: " + std::string(file) +
                          " is missing; --authority names one, fieldcast secure init makes one");
    }
  }
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

std::string Authority::issue_for(const Member& member, const std::string& key, UtcTime now,
                                 Duration life) const {
  std::string certificate = issue(identities(), key, subject_for(member), from_now(now, life));
  write_new(path(kIssued) + '/' + read_certificate(certificate).serial + ".pem", certificate,
            kForAll);
  return certificate;
}

Grant Authority::grant(const Member& member, const std::string& certificate) const {
  const CertificateFacts facts = read_certificate(certificate);
  return {member, facts.subject, facts.not_before, facts.not_after};
}

std::string Authority::add(const Member& member, UtcTime now, Duration life) {
  if (const std::string fault = fault_of(member); !fault.empty()) throw SecurityError(fault);
  const std::string folder = member_folder(member.name);
  std::error_code none;
  if (fs::exists(folder, none)) {
    throw SecurityError("there is a member " + member.name +
                        " already; fieldcast secure renew makes its certificate anew");
  }
  const std::string key = new_key();
  const std::string certificate = issue_for(member, key, now, life);
  const std::string permitted = sign(permissions(), permissions_text(grant(member, certificate)));
  make_folder(folder);
  write_new(joined(folder, kIdentityKey), key, kOwnerOnly);
  write_new(joined(folder, kIdentity), certificate, kForAll);
  write_new(joined(folder, kPermissions), permitted, kForAll);
  for (const std::string_view shared : {kIdentityCa, kPermissionsCa, kGovernance, kRevoked})
    write_new(joined(folder, shared), read_file(path(shared)), kForAll);
  write_new(joined(folder, kMember), member_text(member), kForAll);
  return folder;
}

MemberState Authority::state_of(const std::string& name) const {
  const std::string folder = member_folder(name);
  std::error_code none;
  if (!fault_of({MemberRole::kStation, name, {}}).empty() || !fs::exists(folder, none))
    throw SecurityError("there is no member " + name);
  auto member = member_from(read_file(joined(folder, kMember)));
  if (!member) throw SecurityError(joined(folder, kMember) + ": " + member.error());
  const std::string certificate = read_file(joined(folder, kIdentity));
  return {*std::move(member), folder, read_certificate(certificate),
          is_revoked(read_file(path(kRevoked)), certificate)};
}

void Authority::renew(const std::string& name, UtcTime now, Duration life) {
  const MemberState state = state_of(name);
  if (state.revoked) throw SecurityError(name + " is revoked; add a member with another name");
  const std::string key = read_file(joined(state.folder, kIdentityKey));
  const std::string certificate = issue_for(state.member, key, now, life);
  const std::string permitted =
      sign(permissions(), permissions_text(grant(state.member, certificate)));
  replace(joined(state.folder, kIdentity), certificate, kForAll);
  replace(joined(state.folder, kPermissions), permitted, kForAll);
  for (const std::string_view shared : {kGovernance, kRevoked})
    replace(joined(state.folder, shared), read_file(path(shared)), kForAll);
}

void Authority::revoke(const std::string& name, UtcTime now) {
  const MemberState state = state_of(name);
  if (state.revoked) throw SecurityError(name + " is revoked already");
  std::string list = read_file(path(kRevoked));
  for (const auto& entry : fs::directory_iterator(path(kIssued))) {
    const std::string certificate = read_file(entry.path());
    if (read_certificate(certificate).subject == state.certificate.subject)
      list = security::revoke(identities(), list, certificate, now);
  }
  replace(path(kRevoked), list, kForAll);
  for (const MemberState& other : members()) replace(joined(other.folder, kRevoked), list, kForAll);
}

std::vector<MemberState> Authority::members() const {
  std::vector<MemberState> all;
  for (const auto& entry : fs::directory_iterator(path(kMembers)))
    all.push_back(state_of(entry.path().filename().string()));
  std::ranges::sort(all, {}, [](const MemberState& state) { return state.member.name; });
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

void check_files(const std::string& folder, const Member& member, UtcTime now, MemberCheck& check) {
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
  } catch (const SecurityError& error) { check.faults.push_back(folder + ": " + error.what()); }
  return check;
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

std::string date_text(UtcTime time) { return xml_time(time).substr(0, 10); }

}  // namespace fieldcast::security
