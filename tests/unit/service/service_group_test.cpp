#include "common/service/service_group.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "common/messages/channels.hpp"
#include "common/transport/memory_bus.hpp"
#include "tests/support/temporary_folder.hpp"

namespace eg::service {
namespace {

using namespace std::chrono_literals;
using messages::Acknowledge;
using testing::ElementsAre;
using testing::HasSubstr;
namespace channels = messages::channels;

/// Notes the acknowledgements that it hears, and saves how many there were.
class NotingService : public Service {
 public:
  explicit NotingService(ServiceContext& context) : context_(context) {
    context.subscribe<Acknowledge>(channels::kAcknowledge, 0, [this](const Acknowledge&) { ++heard_; });
  }
  base::Status save() override {
    std::ofstream(context_.options().out / "heard.txt", std::ios::app) << heard_ << '\n';
    return {};
  }

 private:
  ServiceContext& context_;
  int heard_ = 0;
};

class ServiceGroupTest : public testing::Test {
 protected:
  ServiceGroupTest() {
    program_.name = "noter";
    program_.make = [](ServiceContext& context) { return std::make_unique<NotingService>(context); };
    options_.name = program_.name;
    options_.out = folder_.path();
  }

  base::Result<std::unique_ptr<ServiceGroup>> make(std::vector<std::string> robots) {
    program_.robots = std::move(robots);
    return ServiceGroup::make(bus_, program_, options_);
  }
  std::string saved(const std::string& robot) {
    std::ifstream file(folder_.path() / robot / "heard.txt");
    return {std::istreambuf_iterator<char>(file), {}};
  }

  test::TemporaryFolder folder_;
  std::shared_ptr<transport::MemoryNetwork> network_ = std::make_shared<transport::MemoryNetwork>();
  transport::MemoryBus bus_{network_};
  transport::MemoryBus bus_of_a_{network_, "a_"};
  transport::MemoryBus bus_of_b_{network_, "b_"};
  ServiceContext a_{bus_of_a_, {}};
  ServiceContext b_{bus_of_b_, {}};
  ServiceProgram program_;
  ServiceOptions options_;
};

TEST_F(ServiceGroupTest, RefusesAFolderThatCannotBeWrittenTo) {
  options_.out = "/proc/self/task";
  const auto group = make({});
  ASSERT_FALSE(group);
  EXPECT_THAT(group.error().message, HasSubstr("/proc/self/task: cannot be written to"));
}

TEST_F(ServiceGroupTest, RobotsShareNothing) {
  const auto group = make({"a_", "b_"});
  ASSERT_TRUE(group) << group.error().message;
  std::map<std::string, int> statuses;
  a_.subscribe<messages::ServiceStatus>(channels::kStatus, 0,
                                        [&](const auto& status) { ++statuses["a " + status.service]; });
  b_.subscribe<messages::ServiceStatus>(channels::kStatus, 0,
                                        [&](const auto& status) { ++statuses["b " + status.service]; });
  a_.publish(channels::kAcknowledge, Acknowledge{1, 0, "x"});
  b_.publish(channels::kAcknowledge, Acknowledge{1, 0, "x"});
  b_.publish(channels::kAcknowledge, Acknowledge{1, 1, "x"});
  ASSERT_TRUE((*group)->step(0ms));
  ASSERT_TRUE((*group)->save());
  EXPECT_EQ(saved("a_"), "1\n");
  EXPECT_EQ(saved("b_"), "2\n");
  EXPECT_TRUE(bus_of_a_.handle(0ms) && bus_of_b_.handle(0ms));
  EXPECT_THAT(statuses, ElementsAre(testing::Pair("a noter", 1), testing::Pair("b noter", 1)));
}

TEST_F(ServiceGroupTest, SavesAgainWhatARobotHasSaidWhileAnotherWasServed) {
  const auto group = make({"a_", "b_"});
  ASSERT_TRUE(group);
  b_.publish(channels::kAcknowledge, Acknowledge{1, 0, "x"});
  ASSERT_TRUE((*group)->step(0ms) && (*group)->save());
  b_.publish(channels::kAcknowledge, Acknowledge{1, 1, "x"});
  ASSERT_TRUE((*group)->step(0ms) && (*group)->save());
  EXPECT_EQ(saved("b_"), "1\n2\n");
  EXPECT_EQ(saved("a_"), "0\n") << "nothing new";
}

TEST_F(ServiceGroupTest, OneRobotsRequestsAreNotAnothers) {
  const auto group = make({"a_", "b_"});
  ASSERT_TRUE(group);
  a_.publish(channels::kControl, messages::Control{1, messages::Command::shutdown, ""});
  ASSERT_TRUE((*group)->step(0ms));
  EXPECT_EQ(saved("a_"), "0\n");
  EXPECT_EQ(saved("b_"), "");
  EXPECT_FALSE((*group)->ended()) << "the other goes on";
  b_.publish(channels::kControl, messages::Control{2, messages::Command::shutdown, ""});
  ASSERT_TRUE((*group)->step(0ms));
  EXPECT_TRUE((*group)->ended());
}

TEST_F(ServiceGroupTest, WithoutRobotsThereIsOneServiceAndNoPrefix) {
  const auto group = make({});
  ASSERT_TRUE(group);
  ServiceContext anybody(bus_, {});
  anybody.publish(channels::kAcknowledge, Acknowledge{1, 0, "x"});
  ASSERT_TRUE((*group)->step(0ms) && (*group)->save());
  EXPECT_EQ(saved(""), "1\n");
}

TEST_F(ServiceGroupTest, RefusesPrefixesThatAreNoFolders) {
  for (const char* prefix : {"", "../up_", "a/b", "."}) EXPECT_FALSE(make({prefix})) << prefix;
  EXPECT_THAT(make({"a_", "a_"}).error().message, HasSubstr("robot 'a_' is there twice"));
  EXPECT_THAT(make({"a/b"}).error().message, HasSubstr("robot 'a/b': the prefix also names a folder"));
  EXPECT_THAT(make({"a*"}).error().message, HasSubstr("a*"));
}

TEST_F(ServiceGroupTest, SaysWhichRobotCouldNotBeServed) {
  program_.make = [](ServiceContext& context) -> base::Result<std::unique_ptr<Service>> {
    if (context.options().robot == "b_") return base::fail("its journal is damaged");
    return std::make_unique<NotingService>(context);
  };
  EXPECT_EQ(make({"a_", "b_"}).error().message, "robot 'b_': its journal is damaged");
}

}  // namespace
}  // namespace eg::service
