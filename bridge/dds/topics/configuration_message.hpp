// ConfigurationRequest and ConfigurationReply: one JSON text in parts. Texts beyond the limit and
// parts out of order are rejected, because data from DDS is not trusted. Pure.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

namespace fieldcast {

struct ConfigurationMessage {
  static constexpr std::size_t kMostBytes = 4u << 20;  // of `text`

  std::string requester;
  std::uint64_t request_id = 0;
  std::string bridge;
  std::string text;  // JSON
};

inline constexpr std::size_t kConfigurationPart = 8192;  // bytes

// Passes the message in parts to `write`, of idl::ConfigurationRequest or idl::ConfigurationReply.
template <class Part>
void to_parts(const ConfigurationMessage& message, const std::function<void(Part& part)>& write) {
  Part part;
  part.requester() = message.requester;
  part.request_id(message.request_id);
  part.bridge() = message.bridge;
  std::size_t at = 0;
  for (std::uint32_t number = 0; at < message.text.size() || number == 0; ++number) {
    const std::string piece = message.text.substr(at, kConfigurationPart);
    at += piece.size();
    part.part(number);
    part.last(at >= message.text.size());
    part.text().assign(piece.begin(), piece.end());
    write(part);
  }
}

// Collects the parts of one message. One owner.
class ConfigurationParts {
 public:
  // kOther: a part was lost or the text is too long; the message cannot be completed.
  enum class Added : std::uint8_t { kMore, kWhole, kOther };
  template <class Part>
  [[nodiscard]] Added add(const Part& part) {
    if (part.part() != next_ ||
        text_.size() + part.text().size() > ConfigurationMessage::kMostBytes)
      return Added::kOther;
    ++next_;
    text_.append(part.text().begin(), part.text().end());
    return part.last() ? Added::kWhole : Added::kMore;
  }
  // Once add() has returned kWhole.
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::uint32_t next_ = 0;
  std::string text_;
};

}  // namespace fieldcast
