#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

struct ssl_ctx_st;

namespace clipgs {

/// What a server shows to browsers in its network, where no authority vouches for it: a self-signed
/// certificate (P-256) and its private key.
struct Certificate {
  std::string certificate;  ///< PEM
  std::string key;          ///< PEM
};

/// For these IP addresses or host names, and for a year from now. Throws Error.
Certificate make_certificate(const std::vector<std::string>& hosts);

/// Whether it is for all of `hosts`, and good for another week.
bool is_good(const Certificate& certificate, const std::vector<std::string>& hosts);

/// An authority's certificate, with those that lead to it behind it, and its key. Throws Error,
/// also of a key that everybody may read, or that belongs to another certificate.
Certificate load_certificate(const std::filesystem::path& certificate_file,
                             const std::filesystem::path& key_file);

/// Makes a server show it; returns whether OpenSSL takes it.
bool use_certificate(ssl_ctx_st& context, const Certificate& certificate);

/// SHA-256, as browsers show it: "AB:CD:…".
std::string fingerprint(const Certificate& certificate);

/// What is kept for the next time, so that a headset knows the server again.
struct ServerIdentity {
  Certificate certificate;
  /// The secret part of the address, see make_token(); "": it has none.
  std::string token;
};

/// The identity in `folder`, readable by its owner alone; made where there is none, and its
/// certificate made anew where it is no longer good, as is a token of another form. Throws Error.
ServerIdentity load_identity(const std::filesystem::path& folder,
                             const std::vector<std::string>& hosts);

/// IPv4 addresses of this machine in its networks, without the loopback's.
std::vector<std::string> network_addresses();

}  // namespace clipgs
