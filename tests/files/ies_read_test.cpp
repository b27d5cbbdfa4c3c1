// Photometric files: what is read, and how what is wrong is named.
#include "files/ies_read.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

namespace goldthread {
namespace {

using ::testing::HasSubstr;

constexpr double kRound = 3.14159265358979323846;

// A file as parts, each of which a test may change. Candela by default are 100 + 10 v + h, of indices.
struct IesText {
  std::string header = "IESNA:LM-63-2002\n[TEST] of formulas\n[MANUFAC] TILT=ED\n";
  std::string tilt = "TILT=NONE\n";
  std::string lamps = "1 -1 ";
  std::string multiplier = "1 ";
  std::string counts;  // by default those of the angles
  std::string type = "1 ";
  std::string opening = "2 0.1 0.2 0\n";
  std::string factors = "1 1 50\n";
  std::vector<double> vertical = {0, 45, 90};
  std::vector<double> horizontal = {0, 45, 90};
  std::string candela;
  std::string end = "\n";

  std::string text() const {
    std::string out = header + tilt + lamps + multiplier;
    out += counts.empty() ? fmt::format("{} {} ", vertical.size(), horizontal.size()) : counts;
    out += type + opening + factors;
    for (const std::vector<double>* const angles : {&vertical, &horizontal}) {
      for (size_t i = 0; i < angles->size(); ++i) out += fmt::format("{}{}", i > 0 ? " " : "", (*angles)[i]);
      out += '\n';
    }
    if (!candela.empty()) return out + candela + end;
    for (size_t h = 0; h < horizontal.size(); ++h)
      for (size_t v = 0; v < vertical.size(); ++v) out += fmt::format("{} ", 100 + 10 * v + h);
    return out + end;
  }
};

LightProfile read(const std::string& text) {
  Result<LightProfile> profile = parse_ies(text, "a.ies");
  if (!profile) throw std::runtime_error(profile.error().line());
  return *std::move(profile);
}

std::string error_of(const std::string& text) {
  const Result<LightProfile> profile = parse_ies(text, "a.ies");
  EXPECT_TRUE(profile || profile.error().code == ErrorCode::kBadInput);
  EXPECT_TRUE(profile || !profile.error().cure.empty());
  return profile ? "none" : profile.error().line();
}

std::string error_with(const std::function<void(IesText&)>& change) {
  IesText ies;
  change(ies);
  return error_of(ies.text());
}

float nadir(const std::string& text) {
  return read(text).intensity(vec3(0, 0, -1));
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = 0; (at = text.find(what, at)) != text.npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

TEST(Ies, AnglesAndCandelaAreThoseOfTheFile) {
  const LightProfile profile = read(IesText().text());
  EXPECT_EQ(profile.pole, LightProfile::Pole::kNadir);
  EXPECT_EQ(profile.polar, (std::vector<float>{0, 45, 90}));
  EXPECT_EQ(profile.azimuth, (std::vector<float>{0, 45, 90, 135, 180, 225, 270, 315, 360}));
  EXPECT_EQ(profile.candela.size(), 27u);
  EXPECT_FLOAT_EQ(profile.intensity(vec3(1, 0, 0)), 120);
  EXPECT_FLOAT_EQ(profile.intensity(vec3(0, 1, 0)), 122);
  EXPECT_FLOAT_EQ(profile.intensity(vec3(0, -1, 0)), 122);
  EXPECT_FALSE(profile.changes_with_tilt);
}

TEST(Ies, IsotropicFluxIsFourPi) {
  IesText ies;
  ies.vertical = {0, 90, 180};
  ies.horizontal = {0};
  ies.candela = "25 25 25";
  EXPECT_NEAR(read(ies.text()).luminous_flux(), 4 * kRound * 25, 1e-6);
}

TEST(Ies, HeadersOfEveryYear) {
  // The field after the ballast factor counts until 1995 only.
  IesText ies;
  ies.factors = "0.5 0.25 50\n";
  ies.multiplier = "2 ";
  for (const char* const header : {"", "any words\nmore words\n", "IESNA91\n[TEST] 1\n", "IESNA:LM-63-1991\n",
                                   "IESNA:LM-63-1995\n[TEST] 1\n"}) {
    ies.header = header;
    EXPECT_FLOAT_EQ(nadir(ies.text()), 25) << header;
  }
  for (const char* const header : {"IESNA:LM-63-2002\n", "IES:LM-63-2019\n",
                                   "\xEF\xBB\xBF"
                                   "iesna:lm-63-2002 \n"}) {
    ies.header = header;
    EXPECT_FLOAT_EQ(nadir(ies.text()), 100) << header;
  }
}

TEST(Ies, NumbersWrapAsTheyLike) {
  const std::string text = IesText().text();
  const size_t numbers = text.find("TILT=NONE\n") + 10;
  const std::string head = text.substr(0, numbers), tail = text.substr(numbers);
  const LightProfile expected = read(text);
  for (const char* const by : {"\n", "\r\n", ", ", ",", "\r", "  \t\n\n "})
    EXPECT_EQ(read(head + replaced(replaced(tail, "\n", " "), " ", by)).candela, expected.candela) << by;
  EXPECT_EQ(read(replaced(text, "\n", "\r\n")).candela, expected.candela);
  EXPECT_EQ(read(replaced(text, "\n", "\r")).candela, expected.candela);
  EXPECT_EQ(read(replaced(text, "TILT=NONE", " tilt = none ")).candela, expected.candela);
  EXPECT_EQ(read(text + "\x1a junk 1 2 3 nan\n").candela, expected.candela);
  EXPECT_EQ(read(replaced(text, " 45", " +4.5e1")).candela, expected.candela);
}

TEST(Ies, SymmetryOfEachRange) {
  const auto azimuth = [](std::vector<double> horizontal) {
    IesText ies;
    ies.horizontal = std::move(horizontal);
    return read(ies.text()).azimuth;
  };
  EXPECT_EQ(azimuth({0}), (std::vector<float>{0}));
  EXPECT_EQ(azimuth({0, 90}), (std::vector<float>{0, 90, 180, 270, 360}));
  EXPECT_EQ(azimuth({0, 60, 180}), (std::vector<float>{0, 60, 180, 300, 360}));
  EXPECT_EQ(azimuth({90, 120, 270}), (std::vector<float>{90, 120, 270, 420, 450}));
  EXPECT_EQ(azimuth({0, 100, 360}), (std::vector<float>{0, 100, 360}));
  EXPECT_EQ(azimuth({0, 120, 240}), (std::vector<float>{0, 120, 240, 360}));  // the 360 left out
  EXPECT_EQ(azimuth({0, 90.005}), (std::vector<float>{0, 90, 180, 270, 360}));
}

TEST(Ies, TypeBIsTheSameLightAsTypeC) {
  // A Lambertian downlight; of type B only a quarter.
  const auto file = [](const char* type, const std::function<double(double v, double h)>& candela,
                       int last_h) {
    IesText ies;
    ies.type = type;
    ies.vertical.clear();
    ies.horizontal.clear();
    for (int v = 0; v <= 90; ++v) ies.vertical.push_back(v);
    for (int h = 0; h <= last_h; ++h) ies.horizontal.push_back(h);
    for (const double h : ies.horizontal)
      for (const double v : ies.vertical)
        ies.candela += std::to_string(candela(v * kRound / 180, h * kRound / 180)) + '\n';
    return read(ies.text());
  };
  const LightProfile c = file(
      "1 ", [](double v, double) { return 80 * std::cos(v); }, 0);
  const LightProfile b = file(
      "2 ", [](double v, double h) { return 80 * std::cos(v) * std::cos(h); }, 90);
  EXPECT_EQ(b.pole, LightProfile::Pole::kSide);
  EXPECT_NEAR(c.luminous_flux(), 80 * kRound, 0.02);
  EXPECT_NEAR(b.luminous_flux(), 80 * kRound, 0.02);
  for (const vec3& d :
       {vec3(0, 0, -1), vec3(.6f, 0, -.8f), vec3(0, .6f, -.8f), vec3(-.48f, -.64f, -.6f), vec3(0, 0, 1)})
    EXPECT_NEAR(c.intensity(d), b.intensity(d), 0.02);
}

TEST(Ies, TiltFactorsAreUsedAtNoTiltOnly) {
  IesText ies;
  ies.tilt = "TILT=INCLUDE\n1\n3\n0 45 90\n0.5 0.4\n0.3\n";
  EXPECT_FLOAT_EQ(nadir(ies.text()), 50);
  EXPECT_TRUE(read(ies.text()).changes_with_tilt);
  ies.tilt = "TILT=INCLUDE\n1 2 -10 10 0.6 0.8\n";
  EXPECT_FLOAT_EQ(nadir(ies.text()), 70);
  const auto tilt = [](const char* text) { return error_with([&](IesText& i) { i.tilt = text; }); };
  EXPECT_THAT(tilt("TILT=INCLUDE\n1 2 10 20 0.6 0.8\n"), HasSubstr("no tilt factor for a tilt of 0"));
  EXPECT_THAT(tilt("TILT=INCLUDE\n1 2 10 0 0.6 0.8\n"), HasSubstr("do not ascend"));
  EXPECT_THAT(tilt("TILT=INCLUDE\n4 2 0 10 0.6 0.8\n"), HasSubstr("lamp-to-luminaire geometry is 4"));
  EXPECT_THAT(tilt("TILT=INCLUDE\n1 2 0 10 0.6 -0.8\n"), HasSubstr("tilt factor is -0.8"));
  EXPECT_THAT(tilt("TILT=INCLUDE\n1 1e9 0\n"), HasSubstr("number of tilt angles is 1000000000"));
  EXPECT_THAT(tilt("TILT=lamp.tlt\n"), HasSubstr("line 4: TILT=lamp.tlt keeps"));
  EXPECT_THAT(tilt("TILT=\n"), HasSubstr("names nothing; write TILT=NONE"));
  EXPECT_THAT(tilt(""), HasSubstr("a.ies: has no TILT= line"));
}

TEST(Ies, WhatIsNoIesFileIsSaid) {
  EXPECT_THAT(error_of(""), HasSubstr("the file is empty"));
  EXPECT_THAT(error_of("\xEF\xBB\xBF \r\n"), HasSubstr("the file is empty"));
  EXPECT_THAT(error_of(std::string("\x89PNG\0\0\1", 7)), HasSubstr("is not text"));
  EXPECT_THAT(error_of("just words\n"), HasSubstr("has no TILT= line"));
  EXPECT_THAT(error_of("TILT=NONE"), HasSubstr("line 1: the file ends where the number of lamps is due"));
  const Result<LightProfile> none = read_ies("/no/such/lamp.ies");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().line(), HasSubstr("no such file"));
}

TEST(Ies, ReadsFromDisk) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "goldthread_ies_read_test.ies";
  std::ofstream(path, std::ios::binary) << IesText().text();
  const Result<LightProfile> profile = read_ies(path.string());
  std::filesystem::remove(path);
  ASSERT_TRUE(profile);
  EXPECT_EQ(profile->peak(), 122);
}

TEST(Ies, WrongHeadNumbersAreNamed) {
  const auto counts = [](const char* text) { return error_with([&](IesText& i) { i.counts = text; }); };
  EXPECT_THAT(counts("0 3 "), HasSubstr("line 5: the number of vertical angles is 0, not a whole number"));
  EXPECT_THAT(counts("-3 3 "), HasSubstr("vertical angles is -3"));
  EXPECT_THAT(counts("3 2.5 "), HasSubstr("horizontal angles is 2.5"));
  EXPECT_THAT(counts("1e300 3 "), HasSubstr("vertical angles is 1e+300"));
  EXPECT_THAT(counts("9999 9999 "), HasSubstr("more than the rest of the file can hold"));
  EXPECT_THAT(error_with([](IesText& i) { i.type = "3 "; }),
              HasSubstr("line 5: photometry of type A is not supported; convert"));
  EXPECT_THAT(error_with([](IesText& i) { i.type = "7 "; }), HasSubstr("photometric type is 7"));
  EXPECT_THAT(error_with([](IesText& i) {
                i.type = "2 ";
                i.horizontal = {0};
              }),
              HasSubstr("at least 2 horizontal"));
  EXPECT_THAT(error_with([](IesText& i) { i.multiplier = "0 "; }),
              HasSubstr("candela multiplier is 0, not more"));
  EXPECT_THAT(error_with([](IesText& i) { i.multiplier = "inf "; }),
              HasSubstr("\"inf\" is not a finite number"));
  EXPECT_THAT(error_with([](IesText& i) { i.factors = "-1 1 50\n"; }),
              HasSubstr("line 6: the ballast factor is -1"));
  EXPECT_THAT(error_with([](IesText& i) { i.lamps = "one 100 "; }),
              HasSubstr("\"one\" is not a finite number, where the number of lamps is due"));
}

TEST(Ies, WrongAnglesAreNamed) {
  const auto vertical = [](std::vector<double> v, const char* type = "1 ") {
    return error_with([&](IesText& i) {
      i.vertical = v;
      i.type = type;
    });
  };
  const auto horizontal = [](std::vector<double> h, const char* type = "1 ") {
    return error_with([&](IesText& i) {
      i.horizontal = h;
      i.type = type;
    });
  };
  EXPECT_THAT(vertical({0, 50, 40}), HasSubstr("line 7: vertical angle 3 of 3 is 40 and comes after 50"));
  EXPECT_THAT(vertical({0, 40, 40}), HasSubstr("do not ascend"));
  EXPECT_THAT(vertical({0, 90, 190}), HasSubstr("vertical angle 190 is not within 0 to 180"));
  EXPECT_THAT(vertical({-10, 90}), HasSubstr("vertical angle -10 is not within"));
  EXPECT_THAT(vertical({10, 90}, "2 "), HasSubstr("type B begin with 10"));
  EXPECT_THAT(horizontal({30, 90}), HasSubstr("line 8: horizontal angles begin with 30, not with 0"));
  EXPECT_THAT(horizontal({90}), HasSubstr("horizontal angles begin with 90, not with 0"));
  EXPECT_THAT(horizontal({90, 180}), HasSubstr("end with 180, not with 270"));
  EXPECT_THAT(horizontal({0, 60}), HasSubstr("end with 60, not with 90, 180 or 360"));
  EXPECT_THAT(horizontal({0, 100, 200}), HasSubstr("end with 200"));
  EXPECT_THAT(horizontal({0, 400}), HasSubstr("horizontal angle 400 is not within 0 to 360"));
  EXPECT_THAT(horizontal({-100, 0}, "2 "), HasSubstr("horizontal angle -100 is not within -90 to 90"));
  EXPECT_THAT(horizontal({10, 90}, "2 "), HasSubstr("type B begin with 10"));
}

TEST(Ies, WrongCandelaAreNamed) {
  const auto candela = [](const char* text) { return error_with([&](IesText& i) { i.candela = text; }); };
  EXPECT_THAT(candela("1 2 3\n4 5 6\n7 8"),
              HasSubstr("line 11: the file ends where candela value 9 of 9 is due"));
  EXPECT_THAT(candela("1 2 3\n4 -5 6\n7 8 9"),
              HasSubstr("line 10: candela value 5 of 9 is -5, less than nought"));
  EXPECT_THAT(candela("1 2 3\n4 nan 6\n7 8 9"), HasSubstr("line 10: \"nan\" is not a finite number"));
  EXPECT_THAT(candela("1 2 3 4 1e999 6 7 8 9"), HasSubstr("\"1e999\" is not a finite number"));
  EXPECT_THAT(candela("1 2 3 4 1e99 6 7 8 9"), HasSubstr("too large with its factors"));
  EXPECT_THAT(candela("1 2 3 4 1e-999 6 7 8 9"), HasSubstr("none"));
  // One angle too many is announced: what should be an angle is none.
  EXPECT_THAT(error_with([](IesText& i) { i.counts = "4 3 "; }),
              HasSubstr("line 8: vertical angle 4 of 4 is 0 and comes after 90"));
}

TEST(Ies, NothingThatIsBrokenCrashes) {
  IesText with_tilt;
  with_tilt.tilt = "TILT=INCLUDE\n1\n3\n0 45 90\n0.5 0.4 0.3\n";
  std::mt19937 random(1);
  const std::string letters = "0123456789 -.,+eE\n\rTILT=\t\x80\x00";
  size_t read_well = 0;
  for (const std::string& whole : {IesText().text(), with_tilt.text()}) {
    for (size_t size = 0; size < whole.size(); ++size) (void)parse_ies(whole.substr(0, size), "a.ies");
    for (int round = 0; round < 4000; ++round) {
      std::string text = whole;
      for (unsigned changes = 1 + random() % 4; changes-- > 0;) {
        const size_t at = random() % text.size();
        if (random() % 4 == 0)
          text.erase(at, 1 + random() % 8);
        else
          text[at] = letters[random() % letters.size()];
        if (text.empty()) text = " ";
      }
      const Result<LightProfile> profile = parse_ies(text, "a.ies");
      if (!profile) {
        ASSERT_FALSE(profile.error().message.empty());
        continue;
      }
      ++read_well;
      ASSERT_EQ(profile->candela.size(), profile->polar.size() * profile->azimuth.size());
      ASSERT_TRUE(std::isfinite(profile->luminous_flux()));
      for (const vec3& d : {vec3(0, 0, -1), vec3(0, 0, 1), vec3(.6f, .8f, 0), vec3(-.6f, 0, .8f)}) {
        ASSERT_GE(profile->intensity(d), 0);
        ASSERT_LE(profile->intensity(d), profile->peak() * 1.0001f);
      }
    }
  }
  EXPECT_GT(read_well, 100u);
}

}  // namespace
}  // namespace goldthread
