// A station: prints every value of a DDS domain, and writes one channel when it is told to.
//   station DOMAIN SECONDS [BUS DEVICE CHANNEL NUMBER]
#include <cstdlib>
#include <fieldcast/station.hpp>
#include <iostream>
#include <thread>

int main(int argc, char** argv) {
  if (argc != 3 && argc != 7) return 2;
  fieldcast::DdsSpec dds;
  dds.domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  fieldcast::Station station(dds, "my-station");
  station.subscribe_samples([](const fieldcast::StationSample& sample) {
    std::cout << sample.bus << '/' << sample.device << '/' << sample.channel << ' '
              << fieldcast::to_text(sample.value) << ' ' << fieldcast::to_text(sample.quality)
              << std::endl;
  });
  if (argc == 7) {
    fieldcast::StationCommand write{argv[3], {}};
    write.command.device = argv[4];
    write.command.target = fieldcast::ChannelTarget{argv[5]};
    write.command.values = {std::int64_t{std::atoll(argv[6])}};
    const auto result = station.execute(write);
    std::cout << (result ? to_text(result->state) : to_text(result.error())) << std::endl;
  }
  std::this_thread::sleep_for(std::chrono::seconds{std::atoi(argv[2])});
}
