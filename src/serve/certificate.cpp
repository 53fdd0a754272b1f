#include "serve/certificate.h"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <ctime>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <memory>
#include <net/if.h>
#include <netinet/in.h>
#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include "core/error.h"
#include "core/file.h"
#include "serve/token.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

constexpr long kYear = 365L * 24 * 3600;
constexpr long kWeek = 7L * 24 * 3600;
constexpr long kHour = 3600;  // clocks differ
template <auto Free>
struct Freer {
  template <typename T>
  void operator()(T* p) const {
    Free(p);
  }
};
using X509Ptr = std::unique_ptr<X509, Freer<X509_free>>;
using KeyPtr = std::unique_ptr<EVP_PKEY, Freer<EVP_PKEY_free>>;
using BioPtr = std::unique_ptr<BIO, Freer<BIO_free_all>>;
using ExtensionPtr = std::unique_ptr<X509_EXTENSION, Freer<X509_EXTENSION_free>>;

/// `ok`: what OpenSSL answered.
void require(bool ok) {
  if (!ok) {
    throw Error("the server's certificate cannot be made: OpenSSL refuses; is it up to date?");
  }
}

bool is_address(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return inet_pton(AF_INET, host.c_str(), bytes.data()) == 1 ||
         inet_pton(AF_INET6, host.c_str(), bytes.data()) == 1;
}

void add_extension(X509* certificate, int what, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  const ExtensionPtr extension(X509V3_EXT_conf_nid(nullptr, &context, what, value.c_str()));
  require(extension && X509_add_ext(certificate, extension.get(), -1) == 1);
}

std::string text_of(BIO* bio) {
  const char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return {data, static_cast<size_t>(size)};
}

BioPtr reader_of(const std::string& text) {
  return BioPtr(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

/// Null where it is none.
X509Ptr parse(const Certificate& certificate) {
  const BioPtr text = reader_of(certificate.certificate);
  return X509Ptr(PEM_read_bio_X509(text.get(), nullptr, nullptr, nullptr));
}

KeyPtr parse_key(const Certificate& certificate) {
  const BioPtr text = reader_of(certificate.key);
  return KeyPtr(PEM_read_bio_PrivateKey(text.get(), nullptr, nullptr, nullptr));
}

/// What a file holds, or nothing.
std::string text_in(const fs::path& path) {
  return fs::exists(path) ? read_text(path) : std::string();
}

/// The mask keeps others out before there is anything to read.
void write_secret(const fs::path& path, const std::string& text) {
  const mode_t mask = ::umask(0077);
  try {
    write_text(path, text);
  } catch (...) {
    ::umask(mask);
    throw;
  }
  ::umask(mask);
}

}  // namespace

Certificate make_certificate(const std::vector<std::string>& hosts) {
  const KeyPtr key(EVP_EC_gen("P-256"));
  const X509Ptr certificate(X509_new());
  require(key && certificate);
  X509* const x = certificate.get();
  std::uint64_t serial = 0;
  require(RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof(serial)) == 1);
  ASN1_INTEGER_set_uint64(X509_get_serialNumber(x), serial >> 1);
  require(X509_set_version(x, X509_VERSION_3) == 1);
  X509_gmtime_adj(X509_getm_notBefore(x), -kHour);
  X509_gmtime_adj(X509_getm_notAfter(x), kYear);
  require(X509_set_pubkey(x, key.get()) == 1);
  X509_NAME* const name = X509_get_subject_name(x);
  require(X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC,
                                     reinterpret_cast<const unsigned char*>("clipgs serve"), -1, -1,
                                     0) == 1);
  require(X509_set_issuer_name(x, name) == 1);
  std::string names;
  for (const std::string& host : hosts) {
    names +=
        fmt::format("{}{}:{}", names.empty() ? "" : ",", is_address(host) ? "IP" : "DNS", host);
  }
  add_extension(x, NID_subject_alt_name, names);
  add_extension(x, NID_basic_constraints, "critical,CA:FALSE");
  add_extension(x, NID_key_usage, "critical,digitalSignature");
  add_extension(x, NID_ext_key_usage, "serverAuth");
  require(X509_sign(x, key.get(), EVP_sha256()) > 0);

  const BioPtr certificate_text(BIO_new(BIO_s_mem()));
  const BioPtr key_text(BIO_new(BIO_s_mem()));
  require(PEM_write_bio_X509(certificate_text.get(), x) == 1);
  require(PEM_write_bio_PrivateKey(key_text.get(), key.get(), nullptr, nullptr, 0, nullptr,
                                   nullptr) == 1);
  return {text_of(certificate_text.get()), text_of(key_text.get())};
}

bool is_good(const Certificate& certificate, const std::vector<std::string>& hosts) {
  const X509Ptr x = parse(certificate);
  const KeyPtr key = parse_key(certificate);
  if (!x || !key || X509_check_private_key(x.get(), key.get()) != 1) {
    return false;
  }
  time_t soon = time(nullptr) + kWeek;
  const bool lasts = X509_cmp_time(X509_get0_notAfter(x.get()), &soon) > 0;
  return lasts && std::ranges::all_of(hosts, [&](const std::string& host) {
           return is_address(host)
                      ? X509_check_ip_asc(x.get(), host.c_str(), 0) == 1
                      : X509_check_host(x.get(), host.data(), host.size(), 0, nullptr) == 1;
         });
}

bool use_certificate(SSL_CTX& context, const Certificate& certificate) {
  const BioPtr text = reader_of(certificate.certificate);
  const X509Ptr x(PEM_read_bio_X509(text.get(), nullptr, nullptr, nullptr));
  const KeyPtr key = parse_key(certificate);
  if (!x || !key || SSL_CTX_use_certificate(&context, x.get()) != 1 ||
      SSL_CTX_use_PrivateKey(&context, key.get()) != 1) {
    return false;
  }
  // Those behind it lead to an authority that browsers know.
  while (const X509Ptr next{PEM_read_bio_X509(text.get(), nullptr, nullptr, nullptr)}) {
    if (SSL_CTX_add1_chain_cert(&context, next.get()) != 1) {
      return false;
    }
  }
  ERR_clear_error();  // of the end of the text
  return true;
}

Certificate load_certificate(const fs::path& certificate_file, const fs::path& key_file) {
  struct stat status{};
  if (::stat(key_file.c_str(), &status) == 0 && (status.st_mode & S_IRWXO) != 0) {
    throw Error("{}: everybody on this machine may read this key; run chmod o= {}",
                key_file.string(), key_file.string());
  }
  Certificate certificate{read_text(certificate_file), read_text(key_file)};
  const X509Ptr x = parse(certificate);
  const KeyPtr key = parse_key(certificate);
  if (!x) {
    throw Error("{}: holds no certificate; give a PEM file, your own one first",
                certificate_file.string());
  }
  if (!key || X509_check_private_key(x.get(), key.get()) != 1) {
    ERR_clear_error();
    throw Error("{}: is not the key of {}; give the PEM file that belongs to it", key_file.string(),
                certificate_file.string());
  }
  if (X509_cmp_current_time(X509_get0_notAfter(x.get())) <= 0) {
    throw Error("{}: this certificate's time is over; renew it", certificate_file.string());
  }
  return certificate;
}

std::string fingerprint(const Certificate& certificate) {
  const X509Ptr x = parse(certificate);
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  require(x && X509_digest(x.get(), EVP_sha256(), digest.data(), &size) == 1);
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    text += fmt::format("{}{:02X}", i == 0 ? "" : ":", digest[i]);
  }
  return text;
}

ServerIdentity load_identity(const fs::path& folder, const std::vector<std::string>& hosts) {
  const fs::path certificate_file = folder / "certificate.pem";
  const fs::path key_file = folder / "key.pem";
  const fs::path token_file = folder / "token";
  create_folder(folder);
  ServerIdentity identity{{text_in(certificate_file), text_in(key_file)}, text_in(token_file)};
  if (!is_good(identity.certificate, hosts)) {
    identity.certificate = make_certificate(hosts);
    write_secret(key_file, identity.certificate.key);
    write_secret(certificate_file, identity.certificate.certificate);
  }
  if (!is_token(identity.token)) {
    identity.token = make_token();
    write_secret(token_file, identity.token);
  }
  return identity;
}

std::vector<std::string> network_addresses() {
  std::vector<std::string> addresses;
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) {
    return addresses;
  }
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    constexpr unsigned kUp = IFF_UP | IFF_RUNNING;
    if (one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET &&
        (one->ifa_flags & kUp) == kUp && (one->ifa_flags & IFF_LOOPBACK) == 0) {
      std::array<char, INET_ADDRSTRLEN> text{};
      const auto* address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
      inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size());
      addresses.emplace_back(text.data());
    }
  }
  freeifaddrs(all);
  return addresses;
}

}  // namespace clipgs
