#include "bridge/security/subject.hpp"

#include <openssl/evp.h>
#include <openssl/sha.h>
#include <openssl/x509.h>

#include <charconv>
#include <memory>
#include <stdexcept>

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

}  // namespace fieldcast::security
