// The page for browsers: which files are served, and in which form.
#include "fronts/page_files.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "support/temp_path.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

class PageFilesTest : public testing::Test {
 protected:
  PageFilesTest() {
    std::filesystem::create_directories(folder + "/assets");
    put("../secret.html", "secret");
    put("index.html", "<p>index</p>");
    put("index.html.br", "brotli");
    put("index.html.gz", "gzip");
    put("assets/a-1234.js", "a()");
    put("notes.txt", "not of the page");
  }
  ~PageFilesTest() override { std::filesystem::remove_all(outer); }

  void put(const std::string& name, const std::string& text) const {
    std::ofstream(folder + "/" + name) << text;
  }
  PageFiles load() const { return PageFiles::load(folder, no_log); }

  const std::string outer = tmcl::test::temp_path("page_files");
  const std::string folder = outer + "/page";
};

TEST_F(PageFilesTest, AreFoundByTheTargetOfARequest) {
  const auto page = load();
  const auto* index = page.find("/");
  ASSERT_NE(index, nullptr);
  EXPECT_EQ(index->plain, "<p>index</p>");
  EXPECT_EQ(index->type, "text/html; charset=utf-8");
  EXPECT_FALSE(index->is_constant);
  EXPECT_EQ(page.find("/?from=icon"), index);
  ASSERT_NE(page.find("/assets/a-1234.js"), nullptr);
  EXPECT_TRUE(page.find("/assets/a-1234.js")->is_constant);
}

TEST_F(PageFilesTest, AreNoOthers) {
  const auto page = load();
  for (const auto* target :
       {"", "index.html", "/index.html", "//", "/assets", "/assets/", "/notes.txt",
        "/index.html.gz", "/../secret.html", "/assets/../../secret.html", "/%2e%2e/secret.html",
        "/..%2fsecret.html", "/./", "http://localhost/"}) {
    EXPECT_EQ(page.find(target), nullptr) << target;
  }
}

TEST_F(PageFilesTest, GoInTheSmallestCodingThatTheBrowserReads) {
  const auto page = load();
  const auto& index = *page.find("/");
  EXPECT_EQ(body_for(index, "gzip, deflate, br").coding, "br");
  EXPECT_EQ(body_for(index, "gzip, deflate").bytes, "gzip");
  for (const auto* none : {"", "identity", "br;q=0", "gzip;q=0", "brotli", ",,"})
    EXPECT_EQ(body_for(index, none).bytes, index.plain) << none;
  EXPECT_EQ(body_for(*page.find("/assets/a-1234.js"), "br").bytes, "a()");
}

TEST_F(PageFilesTest, HaveATagThatChangesWithTheContent) {
  const auto first = load().find("/")->tag;
  EXPECT_TRUE(is_known(*load().find("/"), "W/\"other\", " + first));
  EXPECT_FALSE(is_known(*load().find("/"), "W/\"other\""));
  put("index.html", "<p>another</p>");
  EXPECT_FALSE(is_known(*load().find("/"), first));
}

TEST_F(PageFilesTest, SayHowToGetThemWhereTheyAreMissing) {
  std::filesystem::remove(folder + "/index.html");
  EXPECT_THAT(load().find("/")->plain, HasSubstr("apt-get install nodejs npm"));
  EXPECT_EQ(load().find("/assets/a-1234.js"), nullptr);
  EXPECT_THAT(PageFiles::load("/nowhere", no_log).find("/")->plain, HasSubstr("not there"));
}

TEST_F(PageFilesTest, AreNotReadWhereTheyAreTooLarge) {
  put("assets/large.js", std::string(max_page_bytes, ' '));
  EXPECT_THAT(load().find("/")->plain, HasSubstr("not there"));
}

}  // namespace
}  // namespace tmcld::test
