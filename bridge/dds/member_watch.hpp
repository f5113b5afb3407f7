// Looks after the folder of a member while its participant is in the domain: a list of revoked
// certificates that comes later holds at once, without a new start. A renewed certificate is said:
// Fast DDS 2.9.1 reads it when a participant is made.
//
// Owns a thread, "members", that looks at the files each kPeriod. Who was refused once stays so
// until the process ends, whatever the folder says then. A list that is not signed by the authority
// is left alone, and said.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "bridge/dds/incoming_filter.hpp"

namespace fieldcast {

class MemberWatch {
 public:
  static constexpr auto kPeriod = std::chrono::milliseconds{500};

  MemberWatch(std::string folder, std::shared_ptr<IncomingFilter> filter);
  ~MemberWatch();
  MemberWatch(const MemberWatch&) = delete;
  MemberWatch& operator=(const MemberWatch&) = delete;

  // The folder has another certificate than when this was made, and is in order. Any thread.
  [[nodiscard]] bool has_new_identity() const;

 private:
  void run();
  void read_list();
  void look_at_identity();
  void look_at_refused();

  const std::string folder_;
  const std::shared_ptr<IncomingFilter> filter_;
  const std::string identity_;     // the certificate
  std::uint64_t say_refused_ = 1;  // messages in clear, from so many on
  std::uint32_t renewed_ = 0;      // how many times running there was another one
  std::string list_;               // the last one that was good
  std::uint32_t wrong_ = 0;        // how many times running the file was not good
  std::set<std::string> refused_;  // common names
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ends_ = false;
  std::thread thread_;  // last: it uses what is above
};

}  // namespace fieldcast
