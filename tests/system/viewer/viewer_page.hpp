#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <memory>
#include <string>

#include "common/transport/lcm_url.hpp"
#include "tests/support/browser.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/web_client.hpp"

namespace eg::test {

/// The real page of egraph-viewer in a real browser; skipped where there is none.
class ViewerPage : public testing::Test {
 protected:
  void SetUp() override {
    if (!Browser::is_installed()) GTEST_SKIP() << "no browser: apt install chromium-headless-shell";
    address_ = "127.0.0.1:" + std::to_string(free_tcp_port());
    lcm_url_ = transport::lcm_url_for_port(30'000 + getpid() % 10'000);
  }
  void TearDown() override { EXPECT_TRUE(no_process_is_left()); }

  std::unique_ptr<BrowserPage> open(Browser& browser) const {
    auto page = browser.open("http://" + address_);
    page->resize(1440, 900);
    EXPECT_TRUE(page->wait_for("window.egraph && egraph.summary().online"));
    return page;
  }

  std::string address_;
  std::string lcm_url_;
  TemporaryFolder folder_;
};

}  // namespace eg::test
