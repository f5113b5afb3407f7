// A participant of Fieldcast in this process, with the data that an attacker needs: its receive
// addresses, and a writer that it is matched with. A second writer, which is never forged, shows
// that the participant still receives.
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <span>
#include <thread>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/dds/guard/datagram_guard.hpp"
#include "bridge/dds/guard/parameter_list.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast::testing {

// Returns the port at which the reader's participant receives samples; 0 if there is none.
inline std::uint32_t samples_port(dds::DataReader& reader) {
  constexpr std::uint8_t kFirstMulticast = 224;
  eprosima::fastdds::rtps::LocatorList locators;
  reader.get_listening_locators(locators);
  for (const auto& one : locators)
    if (one.kind == LOCATOR_KIND_UDPv4 && one.address[12] < kFirstMulticast) return one.port;
  return 0;
}

// Sends to the sample port of the reader's participant, or to its discovery port, which is the
// previous number (RTPS 2.2, 9.6.1.1).
inline void send_to(dds::DataReader& reader, int socket, std::span<const std::uint8_t> datagram,
                    bool to_discovery) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(samples_port(reader) - (to_discovery ? 1 : 0)));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  (void)::sendto(socket, datagram.data(), datagram.size(), 0,
                 reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

struct AttackedDomain {
  explicit AttackedDomain(const DdsSpec& of) : spec(of) {
    socket.reset(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  }

  // Returns true once samples of both writers arrive: discovery is complete.
  [[nodiscard]] bool is_ready() { return arrives(*forged_writer) && answers(); }
  // Returns true if a new sample of the honest writer arrives within 10 s.
  [[nodiscard]] bool answers() { return arrives(*honest_writer); }

  [[nodiscard]] ParticipantPrefix forged_sender() const {
    ParticipantPrefix prefix{};
    std::copy_n(forged_writer->guid().guidPrefix.value, prefix.size(), prefix.begin());
    return prefix;
  }
  [[nodiscard]] static EntityBytes entity(const rtps::GUID_t& guid) {
    EntityBytes bytes{};
    std::copy_n(guid.entityId.value, bytes.size(), bytes.begin());
    return bytes;
  }
  [[nodiscard]] EntityBytes forged_entity() const { return entity(forged_writer->guid()); }
  [[nodiscard]] EntityBytes reader_entity() const { return entity(reader->guid()); }

  void send(std::span<const std::uint8_t> datagram, bool to_discovery) const {
    send_to(*reader, socket.get(), datagram, to_discovery);
  }

  DdsSpec spec;
  FileDescriptor socket;
  Domain victim{spec, "victim", nullptr};
  dds::DataReader* reader = victim.reader(kSampleTopic, nullptr, dds::StatusMask::none());
  Domain forged{spec, "forged", nullptr}, honest{spec, "honest", nullptr};
  dds::DataWriter* forged_writer = forged.writer(kSampleTopic, "forged");
  dds::DataWriter* honest_writer = honest.writer(kSampleTopic, "honest");

 private:
  bool arrives(dds::DataWriter& writer) {
    const ReturnCode_t ok = ReturnCode_t::RETCODE_OK;
    idl::Sample sample;
    const std::string name = "c" + std::to_string(++written);
    sample.channel(name);
    if (!is_taken(writer.write(&sample))) return false;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    while (std::chrono::steady_clock::now() < end) {
      idl::Sample received;
      dds::SampleInfo info;
      while (reader->take_next_sample(&received, &info) == ok)
        if (info.valid_data && std::string(received.channel()) == name) return true;
      reader->wait_for_unread_message({0, 20'000'000});
    }
    return false;
  }
  std::uint64_t written = 0;
};

inline double resident_megabytes() {
  long pages = 0, resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%ld %ld", &pages, &resident) != 2) resident = 0;
    std::fclose(file);
  }
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace fieldcast::testing
