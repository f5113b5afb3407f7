// Looks after the folder of a member while its participant is in the domain: a list of revoked
// certificates that comes later holds at once, without a new start.
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

 private:
  void run();
  void read_list();

  const std::string folder_;
  const std::shared_ptr<IncomingFilter> filter_;
  std::string list_;               // the last one that was good
  std::uint32_t wrong_ = 0;        // how many times running the file was not good
  std::set<std::string> refused_;  // common names
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ends_ = false;
  std::thread thread_;  // last: it uses what is above
};

}  // namespace fieldcast
