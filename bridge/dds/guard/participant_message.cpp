#include "bridge/dds/guard/participant_message.hpp"

#include <initializer_list>

#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {

namespace {

class NoteBytes {
 public:
  explicit NoteBytes(const ParticipantPrefix& prefix) : bytes_{'R', 'T', 'P', 'S', 2, 2, 1, 15} {
    add(prefix);
  }
  void add(std::initializer_list<std::uint8_t> more) {
    bytes_.insert(bytes_.end(), more.begin(), more.end());
  }
  template <std::size_t size>
  void add(const std::array<std::uint8_t, size>& more) {
    bytes_.insert(bytes_.end(), more.begin(), more.end());
  }
  void add_number(std::uint64_t number) {  // RTPS 2.2, 9.3.2: the upper half is first
    add_little(static_cast<std::uint32_t>(number >> 32));
    add_little(static_cast<std::uint32_t>(number));
  }
  void add_little(std::uint32_t value) {
    for (int i = 0; i < 4; ++i) bytes_.push_back(static_cast<std::uint8_t>(value >> 8 * i));
  }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

constexpr std::uint8_t kHasKeys = 2, kWantsNoAnswer = 2;
constexpr std::uint32_t kOurCount = 0x7fffffff;  // higher than the count of any writer

void add_heartbeat(NoteBytes& message, std::uint64_t number) {
  message.add({static_cast<std::uint8_t>(Submessage::kHeartbeat),
               kLittleEndianFlag | kWantsNoAnswer, 28, 0});
  message.add(kParticipantReader);
  message.add(kParticipantWriter);
  message.add_number(number);  // the first number that it has, and the last
  message.add_number(number);
  message.add_little(kOurCount);
}

void add_end(NoteBytes& message, const ParticipantPrefix& of, std::uint64_t number) {
  message.add({static_cast<std::uint8_t>(Submessage::kData), kLittleEndianFlag | kHasKeys, 52, 0});
  message.add({0, 0, 16, 0});
  message.add(kParticipantReader);
  message.add(kParticipantWriter);
  message.add_number(number);
  message.add({0x70, 0, 16, 0});  // the key: the GUID
  message.add(of);
  message.add({0, 0, 1, 0xc1});
  message.add({0x71, 0, 4, 0, 0, 0, 0, 3});  // disposed and unregistered
  message.add({1, 0, 0, 0});
}

}  // namespace

std::vector<std::uint8_t> participant_gone(const ParticipantPrefix& prefix, std::uint64_t number) {
  NoteBytes message(prefix);
  add_end(message, prefix, number);
  return message.take();
}

std::vector<std::uint8_t> participants_gone(std::span<const ParticipantPrefix> others,
                                            const ParticipantPrefix& server, std::uint64_t number) {
  NoteBytes message(server);
  add_heartbeat(message, number);
  for (const ParticipantPrefix& other : others) add_end(message, other, number++);
  add_end(message, server, number);
  return message.take();
}

}  // namespace fieldcast
