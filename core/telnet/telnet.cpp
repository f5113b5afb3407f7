#include "core/telnet/telnet.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::telnet {
namespace {

constexpr auto kEscape = static_cast<std::uint8_t>(Code::kEscape);

}  // namespace

std::optional<Item> Parser::next(ByteView& in) {
  while (!in.empty()) {
    if (state_ == State::kData && (escaped_ || in[0] != kEscape)) return Data{data(in)};
    // IAC IAC: the second byte begins the next data.
    if (state_ == State::kEscape && in[0] == kEscape) {
      state_ = State::kData;
      escaped_ = true;
      continue;
    }
    const std::uint8_t byte = in[0];
    in = in.subspan(1);
    if (auto item = state_ < State::kSubOption ? command(byte) : subnegotiation(byte)) return item;
  }
  return std::nullopt;
}

// REQUIRES: the first byte is data.
ByteView Parser::data(ByteView& in) {
  const auto end = std::find(in.begin() + 1, in.end(), kEscape);
  const ByteView run = in.first(static_cast<std::size_t>(end - in.begin()));
  in = in.subspan(run.size());
  escaped_ = false;
  return run;
}

std::optional<Item> Parser::command(std::uint8_t byte) {
  if (state_ == State::kData) return state_ = State::kEscape, std::nullopt;
  if (state_ == State::kOption) return state_ = State::kData, OptionRequest{verb_, byte};
  state_ = State::kData;
  const auto code = static_cast<Code>(byte);
  if (code == Code::kSubnegotiation) state_ = State::kSubOption;
  if (code < Code::kWill) return std::nullopt;
  verb_ = code;
  state_ = State::kOption;
  return std::nullopt;
}

std::optional<Item> Parser::subnegotiation(std::uint8_t byte) {
  switch (state_) {
    case State::kSubOption:
      sub_ = {byte, {}};
      overlong_ = false;
      state_ = State::kSub;
      return std::nullopt;
    case State::kSub:
      if (byte == kEscape) return state_ = State::kSubEscape, std::nullopt;
      append(byte);
      return std::nullopt;
    default: break;
  }
  if (byte == kEscape) return append(byte), state_ = State::kSub, std::nullopt;
  const bool ended = static_cast<Code>(byte) == Code::kSubnegotiationEnd;
  if (ended && !overlong_) return state_ = State::kData, std::move(sub_);
  ++dropped_;
  state_ = ended ? State::kData : State::kEscape;
  return ended ? std::nullopt : command(byte);
}

void Parser::append(std::uint8_t byte) {
  if (sub_.bytes.size() == kMaxSubnegotiation) overlong_ = true;
  if (!overlong_) sub_.bytes.push_back(byte);
}

void append_data(Bytes& out, ByteView data) {
  for (const std::uint8_t byte : data) {
    if (byte == kEscape) out.push_back(kEscape);
    out.push_back(byte);
  }
}

void append_request(Bytes& out, const OptionRequest& request) {
  append(out, Bytes{kEscape, static_cast<std::uint8_t>(request.verb), request.option});
}

void append_subnegotiation(Bytes& out, std::uint8_t option, ByteView bytes) {
  append(out, Bytes{kEscape, static_cast<std::uint8_t>(Code::kSubnegotiation), option});
  append_data(out, bytes);
  append(out, Bytes{kEscape, static_cast<std::uint8_t>(Code::kSubnegotiationEnd)});
}

}  // namespace fieldcast::telnet
