#include "bridge/security/subject.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <openssl/sha.h>
#include <openssl/x509.h>

#include <charconv>
#include <memory>
#include <stdexcept>
#include <vector>

namespace fieldcast::security {

namespace {

constexpr std::string_view kOrganization = "Fieldcast";
constexpr std::uint8_t kUpperHalf = 0x80;  // of the hash: reserved for bridges

void append(X509_NAME* name, const char* field, std::string_view value) {
  if (X509_NAME_add_entry_by_txt(name, field, V_ASN1_UTF8STRING,
                                 reinterpret_cast<const unsigned char*>(value.data()),
                                 static_cast<int>(value.size()), -1, 0) != 1)
    throw std::runtime_error("OpenSSL takes no subject name");
}

std::array<std::uint8_t, SHA256_DIGEST_LENGTH> hash_of(const Subject& subject) {
  const std::string der = der_of(subject);
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> hash{};
  unsigned length = 0;
  EVP_Digest(der.data(), der.size(), hash.data(), &length, EVP_sha256(), nullptr);
  return hash;
}

std::optional<std::string_view> between(std::string_view& text, std::string_view begin,
                                        std::string_view end) {
  if (!text.starts_with(begin)) return std::nullopt;
  text.remove_prefix(begin.size());
  const auto at = end.empty() ? text.size() : text.find(end);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view found = text.substr(0, at);
  text.remove_prefix(at);
  return found;
}

}  // namespace

std::string Subject::common_name() const { return name + '.' + std::to_string(number); }

std::string Subject::text() const { return std::string(to_text(role)) + ' ' + name; }

Subject subject_for(const Member& member) {
  const bool upper = member.role == MemberRole::kBridge;
  Subject subject{member.role, member.name, 1};
  while ((hash_of(subject)[0] >= kUpperHalf) != upper) ++subject.number;
  return subject;
}

std::optional<Subject> subject_from(std::string_view slashed) {
  const auto organization = between(slashed, "/O=", "/");
  const auto unit = between(slashed, "/OU=", "/");
  const auto common = between(slashed, "/CN=", "");
  if (!organization || *organization != kOrganization || !unit || !common) return std::nullopt;
  const auto role = member_role_from(*unit);
  const auto point = common->rfind('.');
  if (!role || point == std::string_view::npos) return std::nullopt;
  Subject subject{*role, std::string(common->substr(0, point)), 0};
  const char* const end = common->data() + common->size();
  const auto read = std::from_chars(common->data() + point + 1, end, subject.number);
  if (read.ec != std::errc{} || read.ptr != end || subject.common_name() != *common ||
      !fault_of({subject.role, subject.name, {}}).empty())
    return std::nullopt;
  return subject;
}

std::string der_of(const Subject& subject) {
  const std::unique_ptr<X509_NAME, decltype(&X509_NAME_free)> name(X509_NAME_new(), X509_NAME_free);
  append(name.get(), "O", kOrganization);
  append(name.get(), "OU", to_text(subject.role));
  append(name.get(), "CN", subject.common_name());
  unsigned char* bytes = nullptr;
  const int length = i2d_X509_NAME(name.get(), &bytes);
  if (length < 0) throw std::runtime_error("OpenSSL encodes no subject name");
  std::string der(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(length));
  OPENSSL_free(bytes);
  return der;
}

GuidStart guid_start(const Subject& subject) {
  const auto hash = hash_of(subject);
  GuidStart start{};
  start[0] = static_cast<std::uint8_t>(0x80 | hash[0] >> 1);
  for (std::size_t i = 1; i < start.size(); ++i)
    start[i] = static_cast<std::uint8_t>(hash[i - 1] << 7 | hash[i] >> 1);
  return start;
}

namespace {

// All domains: membership is not a matter of trust. Cyclone DDS 0.10 rejects a domain above 230.
std::string domains() {
  return fmt::format("      <domains><id_range><min>0</min><max>{}</max></id_range></domains>\n",
                     kHighestDomain);
}

std::string head(std::string_view schema) {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<dds xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
      "xsi:noNamespaceSchemaLocation=\"http://www.omg.org/spec/DDS-SECURITY/20170901/{}\">\n",
      schema);
}

std::string topic_rule(std::string_view expression, std::string_view data) {
  return fmt::format(
      "        <topic_rule>\n"
      "          <topic_expression>{}</topic_expression>\n"
      "          <enable_discovery_protection>true</enable_discovery_protection>\n"
      "          <enable_liveliness_protection>true</enable_liveliness_protection>\n"
      "          <enable_read_access_control>true</enable_read_access_control>\n"
      "          <enable_write_access_control>true</enable_write_access_control>\n"
      "          <metadata_protection_kind>NONE</metadata_protection_kind>\n"
      "          <data_protection_kind>{}</data_protection_kind>\n"
      "        </topic_rule>\n",
      expression, data);
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string criteria(std::string_view word, const std::vector<std::string_view>& topics,
                     const std::vector<std::string>& partitions) {
  if (topics.empty()) return {};
  std::string text = fmt::format("      <{}>\n        <topics>\n", word);
  for (const std::string_view topic : topics)
    text += fmt::format("          <topic>{}</topic>\n", topic);
  text += "        </topics>\n        <partitions>\n";
  for (const std::string& partition : partitions)
    text += fmt::format("          <partition>{}</partition>\n", escaped(partition));
  return text + fmt::format("        </partitions>\n      </{}>\n", word);
}

std::string allow_rule(const std::string& rules) {
  if (rules.empty()) return {};
  return fmt::format("    <allow_rule>\n{}{}    </allow_rule>\n", domains(), rules);
}

}  // namespace

std::string governance_text(Protection protection) {
  const std::string_view kind = protection == Protection::kEncrypt ? "ENCRYPT" : "SIGN";
  std::string rules;
  for (const TopicRight& right : topic_rights()) {
    if (right.by_bus) rules += topic_rule(right.topic, kind);
  }
  rules += topic_rule("*", "NONE");
  return head("omg_shared_ca_governance.xsd") +
         fmt::format(
             "  <domain_access_rules>\n    <domain_rule>\n{}"
             "      "
             "<allow_unauthenticated_participants>false</allow_unauthenticated_participants>\n"
             "      <enable_join_access_control>true</enable_join_access_control>\n"
             "      <discovery_protection_kind>{}</discovery_protection_kind>\n"
             "      <liveliness_protection_kind>{}</liveliness_protection_kind>\n"
             "      <rtps_protection_kind>{}</rtps_protection_kind>\n"
             "      <topic_access_rules>\n{}      </topic_access_rules>\n"
             "    </domain_rule>\n  </domain_access_rules>\n</dds>\n",
             domains(), kind, kind, kind, rules);
}

bool protects_messages(std::string_view governance) {
  return governance.find("<rtps_protection_kind>NONE<") == std::string_view::npos;
}

std::string permissions_text(const Grant& grant) {
  const MemberRole role = grant.member.role;
  const std::vector<std::string> all{"*"};
  // Topics limited to buses have a separate rule: Fast DDS 2.9.1 searches a partition in all
  // criteria of a rule, regardless of their topics.
  std::vector<std::string_view> writes, reads, writes_by_bus;
  for (const TopicRight& right : topic_rights()) {
    if (right.writers.has(role))
      (right.by_bus && !grant.member.buses.empty() ? writes_by_bus : writes).push_back(right.topic);
    if (right.readers.has(role)) reads.push_back(right.topic);
  }
  return head("omg_shared_ca_permissions.xsd") +
         fmt::format(
             "  <permissions>\n    <grant name=\"{}\">\n"
             "    <subject_name>{}</subject_name>\n"
             "    <validity><not_before>{}</not_before><not_after>{}</not_after></validity>\n",
             grant.member.name, escaped(grant.subject), xml_time(grant.not_before),
             xml_time(grant.not_after)) +
         allow_rule(criteria("publish", writes, all) + criteria("subscribe", reads, all)) +
         allow_rule(criteria("publish", writes_by_bus, grant.member.buses)) +
         "    <default>DENY</default>\n    </grant>\n  </permissions>\n</dds>\n";
}

std::string xml_time(UtcTime time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}",
                     fmt::gmtime(static_cast<std::time_t>(time.nanoseconds / 1'000'000'000)));
}

}  // namespace fieldcast::security
