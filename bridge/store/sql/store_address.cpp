#include "bridge/store/sql/store_address.hpp"

namespace fieldcast {
namespace {

// postgresql://USER:PASSWORD@HOST: masks from the first ':' after the scheme to the last '@'. An
// unescaped password may contain any of "/?@", so the mask may cover too much.
std::string without_userinfo_password(std::string text) {
  const std::size_t begin = text.find("://") + 3;
  const std::size_t at = text.rfind('@');
  const std::size_t colon = text.find(':', begin);
  if (at == std::string::npos || colon == std::string::npos || colon > at) return text;
  return text.replace(colon + 1, at - colon - 1, "***");
}

// ?password=..&sslpassword=..
std::string without_parameter(std::string text, std::string_view name) {
  for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos;) {
    at += name.size();
    const std::size_t end = text.find('&', at);
    text.replace(at, end == std::string::npos ? std::string::npos : end - at, "***");
  }
  return text;
}

}  // namespace

bool StoreAddress::is_server() const {
  return text_.starts_with("postgresql://") || text_.starts_with("postgres://");
}

bool StoreAddress::is_ambiguous() const {
  if (!is_server()) return false;
  const std::string address = text_.substr(0, text_.find('?')).substr(text_.find("://") + 3);
  const std::size_t at = address.rfind('@');
  return at != std::string::npos && address.find_first_of("/@") < at;
}

std::string StoreAddress::masked() const {
  return is_server() ? without_parameter(without_userinfo_password(text_), "password=") : text_;
}

}  // namespace fieldcast
